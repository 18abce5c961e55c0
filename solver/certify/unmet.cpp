#include "certify/unmet.hpp"

#include "certify/data/lost_digits.hpp"

namespace signorini {
namespace {

const char* why_little_is_left(const Material& material) {
  if (components(material) == 1 && is_constant(material))
    return "there is hardly any stress on triangles of so different sizes: refine the mesh where the gap or "
           "the load has a peak that it does not see, or grade it more gently";
  return "the law is so nearly incompressible or of so different stiffnesses, or there is hardly any stress: "
         "take Poisson's ratio further from 1/2, a smaller contrast, or a mesh that sees what moves the body";
}

}  // namespace

std::vector<std::string> reasons_against(const Discretization& discrete, const Solution& solution,
                                         const AdmissiblePair& pair, const LawOnMesh& laws,
                                         Progress& progress) {
  std::vector<std::string> all = pair.unmet();
  // Rounding leaves less, but where 1 − 2ν or the inverse of a contrast is no more than that.
  constexpr double equilibrium = 1e-9;
  if (solution.summary.residuals.equilibrium > equilibrium)
    all.push_back(std::string("the stress is not in equilibrium, by more than rounding leaves of it where ") +
                  why_little_is_left(discrete.problem.material));
  // A dual displacement may vanish, though what it is held to does not.
  const double largest =
      pair.pressure.is_of_dual ? pair.v.scale() : solution.displacement.cwiseAbs().maxCoeff();
  for (const auto& reasons : {discrete.body.unmet(), discrete.traction.unmet(), laws.unmet(),
                              lost_digits(discrete, largest, progress)})
    all.insert(all.end(), reasons.begin(), reasons.end());
  return all;
}

std::string nothing_takes(const std::vector<ContactPressure::Lack>& lacks) {
  return lacks.empty()
             ? "a load that is no polynomial is known to so many digits, and no fixed part takes the rest: "
               "fix a part, or give loads that are polynomials on both sides of straight lines"
             : "a contact is too short for the mesh to hold the body in balance, and no fixed part takes the "
               "rest: refine the mesh where the body touches, or fix a part";
}

}  // namespace signorini
