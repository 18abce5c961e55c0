#include "run/dual_solution.hpp"

#include <utility>

#include "certify/data/oscillation.hpp"
#include "contact/complete.hpp"
#include "contact/dual_contact.hpp"
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
      has_loads_(!quantity.has_no_loads()) {}

void DualSolution::solve(const Eigen::VectorXd& clearance, double factor, Progress& progress) {
  const DualContact contact =
      dual_contact(base_.contact(), clearance, dual_.condensed_.contact().c, factor, progress);
  const Discretization& discrete = dual_.discretization_;
  Completed all = complete(discrete, dual_.condensed_, contact.clearance, contact.open, progress);
  factor_ = factor;
  largest_factor_ = contact.largest_factor;
  coupling_ = std::move(all.coupling);
  clearance_ = contact.clearance;
  solution_.stress = std::move(all.fields.stress);
  // Where the weight is that of an open contact nothing is stressed, and what is left is rounding.
  if (!dual_.has_loads_ &&
      solution_.stress.lpNorm<Eigen::Infinity>() <= kNoStress * dual_.right_.lpNorm<Eigen::Infinity>())
    solution_.stress.setZero();
  solution_.displacement = std::move(all.fields.displacement);
  solution_.rotation = discrete.traces.rotation(coupling_);
  const Eigen::VectorXd on_rows = discrete.clearance.clearance(contact.clearance);
  solution_.summary.residuals =
      residuals(solution_, on_rows, Eigen::VectorXd::Zero(on_rows.size()), discrete);
}

CertifiedSolution DualSolution::certified(const CertifiedSolution& base, double factor, const LawOnMesh& laws,
                                          Progress& progress) const {
  return {discretization(),
          solution_,
          dual_pair(discretization(), solution_, coupling_, base.pair, factor, progress),
          dual_.remainders_,
          laws,
          progress,
          &base};
}

}  // namespace signorini
