#include "certify/quantities/certified_solution.hpp"

#include "certify/data/oscillation.hpp"
#include "certify/unmet.hpp"

namespace signorini {
CertifiedSolution::CertifiedSolution(const Discretization& of, const Solution& solution,
                                     const Eigen::VectorXd& coupling, const LawOnMesh& laws,
                                     Progress& progress)
    : discrete(of),
      stress(solution.stress),
      pair(admissible_pair(of, solution, coupling, progress)),
      oscillations(
          signorini::oscillations(of, pair.pressure, laws, std::vector(of.triangles(), 0), progress)),
      loads(carry_uncertain_loads(of, laws, pair.pressure)),
      unmet(reasons_against(of, solution, pair, laws, progress)) {
  if (!loads.is_held) unmet.push_back(nothing_takes(pair.pressure.lacks));
}

}  // namespace signorini
