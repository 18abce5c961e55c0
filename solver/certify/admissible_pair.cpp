#include "certify/admissible_pair.hpp"

#include "certify/displacement/relaxation.hpp"
#include "certify/elasticity/airy_minimization.hpp"
#include "certify/elasticity/traction_relaxation.hpp"
#include "certify/membrane/stream_function_minimization.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// Of the bound of an elastic body, as many sweeps without end take off 3 % more (an L-shape, a half-disc, ν
/// = 0.3 and 0.4999), for a multiple of the time.
constexpr int kSweepsOfDisplacement = 1, kSweepsOfTractions = 2;

/// Makes it closer inside the body, and the pressure on Γ_C where that may move.
void improve(const Discretization& discrete, const Solution& solution, const Eigen::VectorXd& clearance,
             AdmissiblePair& pair, Progress& progress) {
  if (discrete.spaces().components == 1) {
    pair.v.relax(work_of_loads(discrete, progress), kStepsFromAverage, progress);
    minimize_stream_function(discrete, pair.v, clearance, pair.pressure, progress);
    return;
  }
  const auto relax_tractions_of_pair = [&](Progress& its) {
    pair.tractions.emplace(discrete, solution.stress, pair.pressure, its);
    relax_tractions(discrete, solution.stress, *pair.tractions, kSweepsOfTractions, its);
  };
  if (discrete.spaces().order == 1) {
    pair.v.relax_on_stars(kSweepsOfDisplacement, progress);
    minimize_airy(discrete, solution.stress, pair.v, clearance, pair.pressure, progress);
    return relax_tractions_of_pair(progress);
  }
  // Neither knows of the other.
  side_by_side(2, progress, [&](int which, Progress& its) {
    if (which == 0)
      relax_tractions_of_pair(its);
    else
      pair.v.relax_on_stars(kSweepsOfDisplacement, its);
  });
}

}  // namespace

std::vector<std::string> AdmissiblePair::unmet() const {
  std::vector<std::string> all = v.unmet();
  if (tractions) all.insert(all.end(), tractions->unmet().begin(), tractions->unmet().end());
  return all;
}

AdmissiblePair admissible_pair(const Discretization& discrete, const Solution& solution,
                               const Eigen::VectorXd& coupling, Progress& progress) {
  const Eigen::VectorXd clearance =
      discrete.clearance.clearance(coupling.tail(discrete.traces.contact_unknowns()));
  AdmissiblePair pair{{discrete, solution, coupling, progress},
                      {discrete, solution.stress, clearance},
                      stream_function_of_balance(discrete, progress)};
  improve(discrete, solution, clearance, pair, progress);
  return pair;
}

AdmissiblePair dual_pair(const Discretization& discrete, const Solution& solution,
                         const Eigen::VectorXd& coupling, std::optional<QuadraticValues> of_balance,
                         const AdmissiblePair& base, double factor, Progress& progress) {
  AdmissiblePair pair{{discrete, solution, coupling, base.v, factor, progress},
                      {discrete, solution.stress, base.pressure, factor},
                      std::move(of_balance)};
  improve(discrete, solution, Eigen::VectorXd::Zero(discrete.clearance.rows.size()), pair, progress);
  return pair;
}

}  // namespace signorini
