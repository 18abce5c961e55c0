#include "run/inf_sup_check.hpp"

#include "fem/inf_sup.hpp"
#include "problem/study.hpp"
#include "run/estimate.hpp"
#include "run/requested_mesh.hpp"

namespace signorini {
namespace {

void require_small(std::int64_t stress_unknowns) {
  if (const auto fault = too_large_for_inf_sup(stress_unknowns))
    throw InvalidProblem(std::vector{Fault{"/mesh", *fault}});
}

}  // namespace

InfSup inf_sup_of(const Problem& problem, const Settings& settings, Observer& observer) {
  if (problem.mesh.adaptive)
    throw InvalidProblem(std::vector{Fault{
        "/mesh/adaptive",
        "the inf-sup constant is that of one mesh, and this one refines itself: leave it out, or solve a "
        "study with \"check\": [\"inf_sup\"], which has the constant of each level"}});
  require_small(estimate(problem, settings.factorization).unknowns.stress);
  Progress progress(observer, settings.time_limit, settings.spent);
  const std::shared_ptr<const Mesh> mesh = requested_mesh(problem, progress);
  const Estimate sizes = estimate(problem, *mesh, settings.factorization);
  require_small(sizes.unknowns.stress);
  Settings after_it = settings;
  after_it.spent += progress.seconds();
  return {problem.scheme, sizes.triangles, sizes.unknowns,
          inf_sup_in_time(problem, *mesh, after_it, observer)};
}

double inf_sup_in_time(const Problem& problem, const Mesh& mesh, const Settings& settings,
                       Observer& observer) {
  Progress progress(observer, settings.time_limit, settings.spent);
  try {
    return inf_sup_constant(problem, mesh, progress);
  } catch (const TimeUp&) {
    throw SolveError(
        "the time limit was reached before the inf-sup constant was known: raise solver.time_limit, take "
        "fewer triangles, or do without it");
  }
}

std::optional<std::string> too_large_for_inf_sup(std::int64_t stress_unknowns) {
  if (stress_unknowns <= most_for_inf_sup) return std::nullopt;
  return "makes " + std::to_string(stress_unknowns) +
         " stress unknowns, and the inf-sup constant is computed for " + std::to_string(most_for_inf_sup) +
         " at most: take fewer triangles, or do without it";
}

}  // namespace signorini
