#include "certify/data/oscillation.hpp"

#include <algorithm>
#include <cmath>

#include "certify/data/jump_oscillation.hpp"
#include "certify/data/linear_remainder.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// Of all triangles in which a load jumps.
constexpr int kCellsOfJumps = 20'000;

}  // namespace

template <int D>
double load_remainder(const Discretization& discrete, int t, CellBudget& budget) {
  const auto corners = discrete.mesh.corners(t);
  const ProjectedLoad& load = discrete.body[t];
  if (!(load.unbalanced > 0)) return 0;
  const double remainder = linear_remainder<D>(corners) * load.unbalanced;
  return load.jumps ? std::min(remainder, jump_oscillation<D>(discrete.problem.body, load, corners, budget))
                    : remainder;
}

template <int D>
double oscillation(const Discretization& discrete, int t, double of_load, const ContactPressure& pressure,
                   const LawOnMesh& laws) {
  const auto corners = discrete.mesh.corners(t);
  double sum = of_load;
  for (int e = 0; e < 3; ++e) {
    const int edge = discrete.mesh.triangle_edges[t][e];
    const double rest =
        discrete.traction.acts_on(edge) ? discrete.traction[edge].rest : pressure.beyond_linear(edge);
    if (rest > 0) sum += linear_remainder_on_edge<D>(corners, e) * rest;
  }
  return sum == 0 ? 0 : sum * std::sqrt(laws.whole(t).softest);
}

Eigen::VectorXd load_remainders(const Discretization& discrete, const std::vector<int>& owners,
                                Progress& progress) {
  const auto of = discrete.spaces().components == 1 ? load_remainder<1> : load_remainder<2>;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(discrete.triangles());
  CellBudget budget{kCellsOfJumps, &progress};
  int jumps = 0;
  for (int t = 0; t < discrete.triangles(); ++t) jumps += owners[t] >= 0 && discrete.body[t].jumps;
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    if (owners[t] < 0) continue;
    budget.share(std::max(1, jumps), [&](CellBudget& own) { all[t] = of(discrete, t, own); });
    jumps -= discrete.body[t].jumps;
  }
  return all;
}

Eigen::VectorXd load_remainders(const Discretization& discrete, Progress& progress) {
  return load_remainders(discrete, std::vector(discrete.triangles(), 0), progress);
}

Eigen::VectorXd oscillations(const Discretization& discrete, const Eigen::VectorXd& of_load,
                             const ContactPressure& pressure, const LawOnMesh& laws,
                             const std::vector<int>& owners, Progress& progress) {
  const auto of = discrete.spaces().components == 1 ? oscillation<1> : oscillation<2>;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(discrete.triangles());
  in_parts(discrete.triangles(), progress, [&](Part part, Progress& own) {
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      if (owners[t] >= 0) all[t] = of(discrete, t, of_load[t], pressure, laws);
    }
  });
  return all;
}

template double load_remainder<1>(const Discretization&, int, CellBudget&);
template double load_remainder<2>(const Discretization&, int, CellBudget&);
template double oscillation<1>(const Discretization&, int, double, const ContactPressure&, const LawOnMesh&);
template double oscillation<2>(const Discretization&, int, double, const ContactPressure&, const LawOnMesh&);

}  // namespace signorini
