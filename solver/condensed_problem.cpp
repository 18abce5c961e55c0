#include "condensed_problem.hpp"

#include "contact/accelerated_uzawa.hpp"
#include "contact/complete.hpp"
#include "contact/rigid_motions.hpp"
#include "stable_mesh.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
ContactResult find_clearance(const ContactComplement& contact, const Method& method, Progress& progress,
                             const Eigen::VectorXd& start) {
  if (contact.size() == 0) return {};
  if (const auto* exact = std::get_if<ActiveSet>(&method))
    return active_set(contact, *exact, progress, start);
  return accelerated_uzawa(contact, std::get<AcceleratedUzawa>(method), progress, start);
}

CondensedProblem::CondensedProblem(const Problem& problem, std::shared_ptr<const Mesh> mesh,
                                   Progress& progress)
    : reused_(false) {
  on_stable_mesh(problem, std::move(mesh),
                 [&](const std::shared_ptr<const Mesh>& stable) { make(problem, stable, progress); });
}

CondensedProblem::CondensedProblem(const Problem& problem, std::shared_ptr<const Operator> kept,
                                   Progress& progress)
    : operator_(std::move(kept)), reused_(true) {
  progress.enter(Phase::assemble);
  discretization_ = std::make_unique<const Discretization>(problem, operator_->mesh());
  held_by_contact_alone(*discretization_);  // refuses a load that lifts the body off
  condensed_ =
      std::make_unique<CondensedContact>(*operator_, assemble_right(*discretization_, progress), progress);
}

void CondensedProblem::make(const Problem& problem, std::shared_ptr<const Mesh> mesh, Progress& progress) {
  discretization_ = std::make_unique<const Discretization>(problem, *mesh);
  const bool held = held_by_contact_alone(*discretization_);
  progress.enter(Phase::assemble);
  const HybridSystem system = assemble(*discretization_, progress);
  progress.enter(Phase::factorize);
  operator_ = std::make_shared<const Operator>(std::move(mesh), discretization_->clearance, system.matrix,
                                               held, progress);
  condensed_ = std::make_unique<CondensedContact>(*operator_, system.right, progress);
}

Solution CondensedProblem::solve(const Settings& settings, Progress& progress, const Eigen::VectorXd& start) {
  progress.enter(Phase::iterate);
  const ContactResult found = find_clearance(contact(), settings.method, progress, start);
  progress.found();
  // The Uzawa iteration leaves its clearances where its tolerance ended it.
  const bool exact = std::holds_alternative<ActiveSet>(settings.method);
  Completed all = complete(*discretization_, *condensed_, found.clearance,
                           exact ? open_unknowns(found.clearance) : std::vector<int>{}, progress);
  Fields fields{std::move(all.fields.stress), std::move(all.fields.displacement),
                all.coupling.tail(found.clearance.size()).cwiseMax(0), std::move(all.coupling),
                found.outcome};
  Solution solution = summarize(*discretization_, std::move(fields), settings, progress);
  solution.summary.reused = reused_;
  return solution;
}

}  // namespace signorini
