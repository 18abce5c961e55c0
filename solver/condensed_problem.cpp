#include "condensed_problem.hpp"

#include "contact/accelerated_uzawa.hpp"
#include "contact/rigid_motions.hpp"
#include "stable_mesh.hpp"
#include "system/hybrid_system.hpp"
#include "system/recovery.hpp"

namespace signorini {
namespace {

/// The contact unknowns whose pressure vanishes exactly: the open ones of the active set. The Uzawa iteration
/// leaves its clearances where its tolerance ended it.
std::vector<int> exactly_open(const Eigen::VectorXd& clearance, const Method& method) {
  std::vector<int> open;
  if (!std::holds_alternative<ActiveSet>(method)) return open;
  for (int i = 0; i < static_cast<int>(clearance.size()); ++i)
    if (clearance[i] > 0) open.push_back(i);
  return open;
}

}  // namespace

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
  Fields fields = complete(found, exactly_open(found.clearance, settings.method), progress);
  Solution solution = summarize(*discretization_, std::move(fields), settings, progress);
  solution.summary.reused = reused_;
  return solution;
}

Fields CondensedProblem::complete(const ContactResult& found, const std::vector<int>& exactly_open,
                                  Progress& progress) {
  const Discretization& problem = *discretization_;
  Eigen::VectorXd x = condensed_->traces(found.clearance, progress);
  Recovered fields = recover(problem, x, progress);
  // A stiff volume (ν → 1/2) costs the factorisation digits that iterative refinement brings back.
  constexpr int most_steps = 3;
  for (int step = 0; step < most_steps && !fields.is_balanced(problem.traces); ++step) {
    const Eigen::VectorXd dx = condensed_->correction(fields.imbalance, exactly_open, progress);
    change(problem, dx, fields, progress);
    x += dx;
  }
  const Eigen::VectorXd clearance = x.tail(found.clearance.size()).cwiseMax(0);
  return {std::move(fields.stress), std::move(fields.displacement), clearance, std::move(x), found.outcome};
}

}  // namespace signorini
