#include "condensed_problem.hpp"

#include "contact/accelerated_uzawa.hpp"
#include "contact/complete.hpp"
#include "contact/rigid_motions.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {

ContactResult find_clearance(const ContactComplement& contact, const Method& method, Progress& progress,
                             const MeanStress& mean_stress, const Eigen::VectorXd& start) {
  if (contact.size() == 0) return {};
  if (const auto* exact = std::get_if<ActiveSet>(&method))
    return active_set(contact, *exact, progress, start);
  return accelerated_uzawa(contact, std::get<AcceleratedUzawa>(method), progress, mean_stress, start);
}

CondensedProblem::CondensedProblem(const Problem& problem, std::shared_ptr<const Mesh> mesh,
                                   Progress& progress)
    : reused_(false), discretization_(std::make_unique<const Discretization>(problem, *mesh)) {
  const bool held = held_by_contact_alone(*discretization_);
  progress.enter(Phase::assemble);
  const HybridSystem system = assemble(*discretization_, progress);
  progress.enter(Phase::factorize);
  operator_ = std::make_shared<const Operator>(std::move(mesh), discretization_->clearance, system.matrix,
                                               held, progress);
  condensed_ = std::make_unique<CondensedContact>(*operator_, system.right, progress);
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

Solution CondensedProblem::solve(const Settings& settings, Progress& progress, const Eigen::VectorXd& start) {
  progress.enter(Phase::iterate);
  // The Uzawa iteration leaves its clearances where its tolerance ended it.
  const bool exact = std::holds_alternative<ActiveSet>(settings.method);
  Completed all;
  Eigen::VectorXd completed;
  const auto complete_for = [&](const Eigen::VectorXd& clearance) {
    progress.found();
    all = complete(*discretization_, *condensed_, clearance,
                   exact ? open_unknowns(clearance) : std::vector<int>{}, progress);
    completed = clearance;
  };
  const auto mean_stress_for = [&](const Eigen::VectorXd& clearance) {
    complete_for(clearance);
    return mean_stress(*discretization_, all.fields.stress, all.fields.displacement);
  };
  const ContactResult found = find_clearance(contact(), settings.method, progress, mean_stress_for, start);
  if (completed.size() == 0 || completed != found.clearance) complete_for(found.clearance);
  Fields fields{std::move(all.fields.stress), std::move(all.fields.displacement),
                all.coupling.tail(found.clearance.size()).cwiseMax(0), std::move(all.coupling),
                found.outcome};
  Solution solution = summarize(*discretization_, std::move(fields), settings, progress);
  solution.summary.reused = reused_;
  return solution;
}

}  // namespace signorini
