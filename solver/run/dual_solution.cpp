#include "run/dual_solution.hpp"

#include <utility>

#include "certify/data/oscillation.hpp"
#include "contact/complete.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

/// Fluxes below this part of the forces that the data make are rounding.
constexpr double kNoStress = 1e-12;

}  // namespace

CondensedDual::CondensedDual(const CondensedProblem& base, const Quantity& quantity, Progress& progress)
    : operator_(base.used_operator()),
      problem_(dual_problem(base.discretization().problem, quantity)),
      discretization_(problem_, operator_->mesh(), LoadProjection(problem_, operator_->mesh(), &progress),
                      &progress, ClearanceOf::change),
      right_(assemble_right(discretization_, progress)),
      condensed_(*operator_, right_, progress),
      remainders_(load_remainders(discretization_, progress)),
      of_balance_(stream_function_of_balance(discretization_, progress)),
      has_loads_(!quantity.has_no_loads()) {}

CondensedDual::Solved& CondensedDual::solved(const DualContact& contact, Progress& progress) {
  if (last_ && last_->clearance == contact.clearance && last_->open == contact.open) return *last_;
  last_.reset();
  const Discretization& discrete = discretization_;
  Completed all = complete(discrete, condensed_, contact.clearance, contact.open, progress);
  Solution solution;
  solution.stress = std::move(all.fields.stress);
  // Where the weight is that of an open contact nothing is stressed, and what is left is rounding.
  if (!has_loads_ &&
      solution.stress.lpNorm<Eigen::Infinity>() <= kNoStress * right_.lpNorm<Eigen::Infinity>())
    solution.stress.setZero();
  solution.displacement = std::move(all.fields.displacement);
  solution.rotation = discrete.traces.rotation(all.coupling);
  last_ = Solved{contact.clearance, contact.open, std::move(all.coupling), std::move(solution)};
  return *last_;
}

void CondensedDual::find_residuals(Solved& solved, Progress& progress) const {
  if (std::exchange(solved.has_residuals, true)) return;
  const Eigen::VectorXd on_rows = discretization_.clearance.clearance(solved.clearance);
  solved.solution.summary.residuals =
      residuals(solved.solution, on_rows, Eigen::VectorXd::Zero(on_rows.size()), discretization_, progress);
}

void DualSolution::solve(const Eigen::VectorXd& clearance, double factor, Progress& progress) {
  const DualContact contact =
      dual_contact(base_.contact(), clearance, dual_.condensed_.contact().c, factor, progress);
  factor_ = factor;
  largest_factor_ = contact.largest_factor;
  solved_ = &dual_.solved(contact, progress);
}

CertifiedSolution DualSolution::certified(const CertifiedSolution& base, double factor, const LawOnMesh& laws,
                                          Progress& progress) const {
  dual_.find_residuals(*solved_, progress);
  return {discretization(),
          solved_->solution,
          dual_pair(discretization(), solved_->solution, solved_->coupling, dual_.of_balance_, base.pair,
                    factor, progress),
          dual_.remainders_,
          laws,
          progress,
          &base};
}

}  // namespace signorini
