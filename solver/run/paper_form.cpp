#include "paper_form.hpp"

#include "certify/certificate.hpp"
#include "condensed_problem.hpp"
#include "contact/paper_uzawa.hpp"
#include "contact/rigid_motions.hpp"
#include "data_check.hpp"
#include "requested_mesh.hpp"
#include "result/summarize.hpp"

namespace signorini {
namespace {

/// The factor is gone with the iteration.
Fields find_fields(const Discretization& discrete, const Settings& settings, Progress& progress) {
  progress.enter(Phase::assemble);
  UzawaIteration iteration(discrete, std::get<PaperUzawa>(settings.method), settings.factorization, progress);
  progress.enter(Phase::iterate);
  const Outcome outcome = iteration.run(progress);
  progress.found();
  return {iteration.stress(), iteration.displacement(), iteration.clearance(), iteration.coupling(), outcome};
}

Solution iterate(const Problem& problem, std::shared_ptr<const Mesh> mesh, const Settings& settings,
                 Progress& progress) {
  const Discretization discrete(problem, *mesh, &progress);
  held_by_contact_alone(discrete);
  Fields fields = find_fields(discrete, settings, progress);
  return describe(discrete, std::move(mesh), fields, settings, progress);
}

/// The certificate of the discrete solution, moved to the iterate.
Certificate certify_iterate(const Problem& problem, const std::shared_ptr<const Mesh>& mesh,
                            const Solution& iterate, Factorization by, Progress& progress) {
  SilentObserver silent(progress.observer());
  Progress within(silent, progress);
  CondensedProblem condensed(problem, mesh, by, within);
  Fields fields = condensed.find(ActiveSet{}, within);
  const Settings exactly{ActiveSet{}, std::nullopt};
  const Solution discrete = describe(condensed.discretization(), mesh, fields, exactly, within);
  Certificate certificate = condensed.certified(fields, discrete, by, within);
  move_to(iterate.stress, condensed.discretization(), discrete, certificate, within);
  return certificate;
}

}  // namespace

Solution iterate_paper_form(const Problem& problem, const Settings& settings, Progress& progress) {
  return iterate(problem, requested_mesh(problem, progress), settings, progress);
}

Solution solve_paper_form(const Problem& problem, const Settings& settings, Progress& progress) {
  const std::shared_ptr<const Mesh> mesh = requested_mesh(problem, progress);
  require_sound_data(problem, *mesh, progress);
  Solution solution = iterate(problem, mesh, settings, progress);
  add_bound(
      problem, [&] { return certify_iterate(problem, mesh, solution, settings.factorization, progress); },
      solution, progress);
  return solution;
}

}  // namespace signorini
