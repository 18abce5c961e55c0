#include "outcome.hpp"

#include <algorithm>
#include <array>

namespace signorini {
namespace {

bool is_answer(const Residuals& left, const PaperUzawa& method) {
  const double largest = std::max({left.equilibrium, left.constitutive, left.penetration, left.tension,
                                   left.complementarity, left.symmetry});
  return largest <= std::max(1e-2, 100 * method.tolerance);
}

bool is_answer(const Residuals& left, double tolerance) {
  return std::max({left.penetration, left.tension, left.complementarity}) <= std::max(1e-9, tolerance);
}

bool is_answer(const Residuals& left, const Mprgp& method) {
  return is_answer(left, method.tolerance);
}

bool is_answer(const Residuals& left, const ActiveSet&) {
  return is_answer(left, Mprgp{}.tolerance);
}

std::string why_stalled(const Settings& settings, const std::string& after) {
  if (std::holds_alternative<PaperUzawa>(settings.method))
    return "the iteration stalled" + after +
           ": the displacement hardly changes from one to the next, which meets the tolerance, but the "
           "residuals say that it is far from the solution; the step rho is too small for this augmentation: "
           "raise rho towards twice the augmentation or lower the augmentation, lower the tolerance, or use "
           "rho and augmentation \"auto\", or active_set";
  const bool exact = std::holds_alternative<ActiveSet>(settings.method);
  return "the contact conditions are not met" + after +
         " as far as the tolerance asks, and rounding keeps the method from more: gaps, loads and stiffness "
         "differ by too many powers of ten, or the body is too thin somewhere; check units and sizes" +
         (exact ? "" : ", raise the tolerance or use active_set");
}

}  // namespace

const char* name(Outcome outcome) {
  static constexpr std::array names{"converged",         "iteration_limit", "time_limit", "diverged",
                                    "tolerance_not_met", "cancelled",       "stalled"};
  return names[static_cast<int>(outcome)];
}

Outcome judged(Outcome outcome, const Residuals& residuals, const Settings& settings) {
  if (outcome != Outcome::converged) return outcome;
  const bool answers =
      std::visit([&](const auto& method) { return is_answer(residuals, method); }, settings.method);
  return answers ? outcome : Outcome::stalled;
}

std::string advice(const Settings& settings, Outcome outcome, int iterations) {
  const std::string after =
      " after " + std::to_string(iterations) + (iterations == 1 ? " iteration" : " iterations");
  const bool paper = std::holds_alternative<PaperUzawa>(settings.method),
             exact = std::holds_alternative<ActiveSet>(settings.method);
  const std::string other = paper ? "use rho and augmentation \"auto\", or active_set" : "use active_set";
  const std::string faster = exact   ? "raise max_iterations"
                             : paper ? other
                                     : "raise max_iterations or " + other;
  switch (outcome) {
    case Outcome::converged:
      return "";
    case Outcome::iteration_limit:
      return "the tolerance was not met" + after + ": raise the tolerance, " + faster;
    case Outcome::time_limit:
      return "the time limit was reached" + after + ": raise solver.time_limit, or " +
             (exact ? "coarsen the mesh" : other);
    case Outcome::stalled:
      return why_stalled(settings, after);
    case Outcome::tolerance_not_met:
    case Outcome::cancelled:
      break;  // said by the loop over meshes that ends so
    case Outcome::diverged:
      return "the Uzawa iteration diverged" + after +
             ": the step rho is too large for this mesh; it must stay below " +
             "twice the augmentation and below a bound that shrinks with the mesh; lower rho or " + faster;
  }
  return "";
}

}  // namespace signorini
