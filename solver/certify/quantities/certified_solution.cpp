#include "certify/quantities/certified_solution.hpp"

#include <utility>

#include "certify/data/oscillation.hpp"
#include "certify/unmet.hpp"

namespace signorini {
namespace {

/// The pressure that takes what is not balanced, with what the solution's own lacks.
ContactPressure taking(const CertifiedSolution* base, const ContactPressure& own) {
  ContactPressure takes = base ? base->pair.pressure : own;
  takes.lacks = own.lacks;
  return takes;
}

}  // namespace

CertifiedSolution::CertifiedSolution(const Discretization& of, const Solution& solution,
                                     AdmissiblePair admissible, const Eigen::VectorXd& of_load,
                                     const LawOnMesh& laws, Progress& progress, const CertifiedSolution* base)
    : discrete(of),
      stress(solution.stress),
      pair(std::move(admissible)),
      oscillations(signorini::oscillations(of, of_load, pair.pressure, laws, std::vector(of.triangles(), 0),
                                           progress)),
      loads(carry_uncertain_loads(of, laws, taking(base, pair.pressure))),
      unmet(reasons_against(of, solution, pair, laws, progress)) {
  if (!loads.is_held) unmet.push_back(nothing_takes(pair.pressure.lacks));
}

}  // namespace signorini
