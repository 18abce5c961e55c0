#include "condensed_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "certify/certificate.hpp"
#include "contact/complete.hpp"
#include "contact/mprgp.hpp"
#include "contact/rigid_motions.hpp"
#include "progress/overflow.hpp"
#include "run/quantities.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

/// How far a foundation is that was drawn near, in displacements.
constexpr double kNear = 1e3;

/// The largest gap at an unknown, beyond the reach too.
double farthest(const ClearanceSpace& space) {
  double most = 0;
  for (const ClearanceRow& row : space.rows)
    if (row.unknown >= 0) most = std::max(most, row.gap + row.beyond);
  return most;
}

/// The forces on the contact unknowns by the stress, w p.
Eigen::VectorXd forces_on_unknowns(const Discretization& discrete, const Eigen::MatrixXd& stress,
                                   Eigen::Index count) {
  Eigen::VectorXd on_rows, forces(count);
  contact_forces(
      discrete, [&](int t) -> LocalVector { return stress.col(t); }, on_rows);
  for (std::size_t i = 0; i < discrete.clearance.rows.size(); ++i)
    if (const int unknown = discrete.clearance.rows[i].unknown; unknown >= 0)
      forces[unknown] = on_rows[static_cast<Eigen::Index>(i)];
  return forces;
}

}  // namespace

bool is_far(const ClearanceSpace& space, double displacement) {
  return farthest(space) > kFar * displacement;
}

ContactResult find_clearance(const ContactComplement& contact, const Method& method, Progress& progress,
                             const StateOfBody& body, const Eigen::VectorXd& start) {
  if (contact.size() == 0) return {};
  if (!contact.s.diagonal().allFinite() || !contact.c.allFinite()) throw Overflow();
  if (const auto* exact = std::get_if<ActiveSet>(&method))
    return active_set(contact, *exact, progress, start);
  return mprgp(contact, std::get<Mprgp>(method), progress, body, start);
}

CondensedProblem::CondensedProblem(const Problem& problem, std::shared_ptr<const Mesh> mesh, Factorization by,
                                   Progress& progress)
    : reused_(false), discretization_(std::make_unique<Discretization>(problem, *mesh, &progress)) {
  const bool held = held_by_contact_alone(*discretization_);
  progress.enter(Phase::assemble);
  HybridSystem system = assemble(*discretization_, progress);
  progress.enter(Phase::factorize);
  system.matrix.tree = tree_by_edges(system.matrix.centres, discretization_->mesh.triangle_edges, progress);
  operator_ = std::make_shared<const Operator>(std::move(mesh), discretization_->clearance, system.matrix,
                                               held, by, progress);
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

Fields CondensedProblem::find(const Method& method, Progress& progress, const Eigen::VectorXd& given) {
  const double whole = farthest(discretization_->clearance);
  Eigen::VectorXd start = given;
  if (whole <= kFar * discretization_->mesh.diameter()) {
    Fields fields = find_as_posed(method, progress, start);
    if (!is_far(discretization_->clearance, fields.displacement.lpNorm<Eigen::Infinity>())) return fields;
    start = fields.clearance;
  }
  // Beside a large gap the displacement may be but noise: the foundation goes away from where the body is.
  for (double reach = 0;;) {
    discretization_->draw_near(reach);
    condense(progress);
    progress.take_history();
    Fields fields = find_as_posed(method, progress, start.cwiseMin(reach));
    const ClearanceSpace& space = discretization_->clearance;
    const bool is_free = reach > 0 && !space.is_touched_too_early(fields.clearance);
    const double displacement = fields.displacement.lpNorm<Eigen::Infinity>();
    if (is_free || displacement == 0 || reach >= whole) return fields;
    const double farther = kNear * std::max(reach, displacement);
    if (!fields.displacement.allFinite() || !(farther > reach)) throw Overflow();
    reach = farther;
  }
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
    return {mean_stress(*discretization_, all.fields.stress, all.fields.displacement,
                        discretization_->clearance.clearance(clearance)),
            forces_on_unknowns(*discretization_, all.fields.stress, clearance.size())};
  };
  const ContactResult found = find_clearance(contact(), method, progress, body, start);
  if (completed.size() == 0 || completed != found.clearance) complete_for(found.clearance);
  return {std::move(all.fields.stress), std::move(all.fields.displacement),
          all.coupling.tail(found.clearance.size()).cwiseMax(0), std::move(all.coupling), found.outcome};
}

Certificate CondensedProblem::certified(const Fields& fields, const Solution& solution, Factorization by,
                                        Progress& progress, KeptDuals* kept) {
  const bool is_used_again = kept != nullptr || !discretization_->problem.quantities.empty();
  if (!is_used_again) {
    condensed_.reset();
    operator_.reset();
    ShapeNorms norms;
    return certify(*discretization_, solution, fields.coupling, norms, progress);
  }
  KeptDuals own(KeptDuals::For::one_solve);
  KeptDuals& all = kept ? *kept : own;
  Certificate certificate = certify(*discretization_, solution, fields.coupling, all.norms(*this), progress);
  try {
    enclose_quantities(*this, fields, solution, by, certificate, all, progress);
  } catch (const TimeUp&) {
    // A mesh that refines itself for one of them keeps the level before.
    if (discretization_->problem.mesh.adaptive) throw;
    certificate.quantities.clear();
    certificate.late =
        "the time limit was reached before the quantities were enclosed: raise solver.time_limit, coarsen "
        "the "
        "mesh or ask for fewer";
  }
  return certificate;
}

Solution CondensedProblem::solve(const Settings& settings, Progress& progress, const Eigen::VectorXd& start,
                                 KeptDuals* kept) {
  progress.enter(Phase::iterate);
  Fields fields = find(settings.method, progress, start);
  Solution solution = describe(*discretization_, operator_->shared_mesh(), fields, settings, progress);
  solution.summary.reused = reused_;
  add_bound(
      discretization_->problem,
      [&] { return certified(fields, solution, settings.factorization, progress, kept); }, solution,
      progress);
  return solution;
}

}  // namespace signorini
