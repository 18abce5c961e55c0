#include "condensed_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/certificate.hpp"
#include "contact/accelerated_uzawa.hpp"
#include "contact/complete.hpp"
#include "contact/rigid_motions.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

/// How far a foundation may be, in displacements, before it is drawn near; and how far it is then.
constexpr double kFar = 1e4, kNear = 1e3;
/// How often, before the displacement is taken for none.
constexpr int kMostPoses = 12;

/// The reach that the gaps should have beside the displacement; infinite if they are near already.
double reach_for(const ClearanceSpace& space, const Fields& fields) {
  const double displacement = fields.displacement.lpNorm<Eigen::Infinity>();
  return is_far(space, displacement) ? kNear * displacement : std::numeric_limits<double>::infinity();
}

/// A foundation was drawn so near that something touches it.
bool touches_beyond(const ClearanceSpace& space, const Eigen::VectorXd& clearance) {
  return std::ranges::any_of(space.rows, [&](const ClearanceRow& row) {
    return row.unknown >= 0 && row.beyond > 0 && clearance[row.unknown] <= 0;
  });
}

/// Nothing loads the body, and all that it moved by was noise; the foundation is drawn near all the way.
Fields at_rest(Fields noise) {
  noise.stress.setZero();
  noise.displacement.setZero();
  noise.clearance.setZero();
  noise.coupling.setZero();
  noise.outcome = Outcome::converged;
  return noise;
}

/// The forces on the contact unknowns by the stress, w p.
Eigen::VectorXd forces_on_unknowns(const Discretization& problem, const Eigen::MatrixXd& stress,
                                   Eigen::Index count) {
  Eigen::VectorXd on_rows, forces(count);
  contact_forces(
      problem, [&](int t) -> LocalVector { return stress.col(t); }, on_rows);
  for (std::size_t i = 0; i < problem.clearance.rows.size(); ++i)
    if (const int unknown = problem.clearance.rows[i].unknown; unknown >= 0)
      forces[unknown] = on_rows[static_cast<Eigen::Index>(i)];
  return forces;
}

}  // namespace

bool is_far(const ClearanceSpace& space, double displacement) {
  return displacement > 0 && std::ranges::any_of(space.rows, [&](const ClearanceRow& row) {
           return row.unknown >= 0 && row.gap > kFar * displacement;
         });
}

ContactResult find_clearance(const ContactComplement& contact, const Method& method, Progress& progress,
                             const StateOfBody& body, const Eigen::VectorXd& start) {
  if (contact.size() == 0) return {};
  if (const auto* exact = std::get_if<ActiveSet>(&method))
    return active_set(contact, *exact, progress, start);
  return accelerated_uzawa(contact, std::get<AcceleratedUzawa>(method), progress, body, start);
}

CondensedProblem::CondensedProblem(const Problem& problem, std::shared_ptr<const Mesh> mesh,
                                   Progress& progress)
    : reused_(false), discretization_(std::make_unique<Discretization>(problem, *mesh, &progress)) {
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
  discretization_ = std::make_unique<Discretization>(problem, operator_->mesh(), &progress);
  held_by_contact_alone(*discretization_);  // refuses a load that lifts the body off
  condense(progress);
}

/// For the right side of the discretization.
void CondensedProblem::condense(Progress& progress) {
  condensed_ =
      std::make_unique<CondensedContact>(*operator_, assemble_right(*discretization_, progress), progress);
}

Fields CondensedProblem::find(const Method& method, Progress& progress, const Eigen::VectorXd& start) {
  const auto pose = [&](double reach) {
    discretization_->draw_near(reach);
    condense(progress);
  };
  Fields fields = find_as_posed(method, progress, start);
  // Beside the largest gaps the first displacement may be but noise; each pose has some digits less of it.
  for (int most = kMostPoses; most > 0; --most) {
    const double reach = reach_for(discretization_->clearance, fields);
    if (!std::isfinite(reach)) return fields;
    pose(reach);
    progress.take_history();
    fields = find_as_posed(method, progress, fields.clearance.cwiseMin(reach));
    if (touches_beyond(discretization_->clearance, fields.clearance)) {
      pose(std::numeric_limits<double>::infinity());
      return find_as_posed(method, progress, {});
    }
  }
  pose(0);
  return at_rest(std::move(fields));
}

Fields CondensedProblem::find_as_posed(const Method& method, Progress& progress,
                                       const Eigen::VectorXd& start) {
  // The Uzawa iteration leaves its clearances where its tolerance ended it.
  const bool exact = std::holds_alternative<ActiveSet>(method);
  Completed all;
  Eigen::VectorXd completed;
  const auto complete_for = [&](const Eigen::VectorXd& clearance) {
    progress.found();
    all = complete(*discretization_, *condensed_, clearance,
                   exact ? open_unknowns(clearance) : std::vector<int>{}, progress);
    completed = clearance;
  };
  const auto body = [&](const Eigen::VectorXd& clearance) -> BodyState {
    complete_for(clearance);
    return {mean_stress(*discretization_, all.fields.stress, all.fields.displacement),
            forces_on_unknowns(*discretization_, all.fields.stress, clearance.size())};
  };
  const ContactResult found = find_clearance(contact(), method, progress, body, start);
  if (completed.size() == 0 || completed != found.clearance) complete_for(found.clearance);
  return {std::move(all.fields.stress), std::move(all.fields.displacement),
          all.coupling.tail(found.clearance.size()).cwiseMax(0), std::move(all.coupling), found.outcome};
}

Solution CondensedProblem::solve(const Settings& settings, Progress& progress, const Eigen::VectorXd& start) {
  progress.enter(Phase::iterate);
  const Fields fields = find(settings.method, progress, start);
  Solution solution = describe(*discretization_, fields, settings, progress);
  solution.summary.reused = reused_;
  const auto bound = [&] { return certify(*discretization_, solution, fields.coupling, progress); };
  add_bound(discretization_->problem, bound, solution, progress);
  return solution;
}

}  // namespace signorini
