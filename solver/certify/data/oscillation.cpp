#include "certify/data/oscillation.hpp"

#include <algorithm>
#include <cmath>

#include "certify/data/jump_oscillation.hpp"
#include "certify/data/linear_remainder.hpp"

namespace signorini {

template <int D>
double oscillation(const Discretization& discrete, int t, const ContactPressure& pressure,
                   const LawOnMesh& laws, CellBudget& budget) {
  const auto corners = discrete.mesh.corners(t);
  const ProjectedLoad& load = discrete.body[t];
  double sum = load.unbalanced > 0 ? linear_remainder<D>(corners) * load.unbalanced : 0;
  if (load.jumps && sum > 0)
    sum = std::min(sum, jump_oscillation<D>(discrete.problem.body, load, corners, budget));
  for (int e = 0; e < 3; ++e) {
    const int edge = discrete.mesh.triangle_edges[t][e];
    const double rest =
        discrete.traction.acts_on(edge) ? discrete.traction[edge].rest : pressure.beyond_linear(edge);
    if (rest > 0) sum += linear_remainder_on_edge<D>(corners, e) * rest;
  }
  return sum == 0 ? 0 : sum * std::sqrt(laws.whole(t).softest);
}

template double oscillation<1>(const Discretization&, int, const ContactPressure&, const LawOnMesh&,
                               CellBudget&);
template double oscillation<2>(const Discretization&, int, const ContactPressure&, const LawOnMesh&,
                               CellBudget&);

}  // namespace signorini
