#include "run/dual_solution.hpp"

#include <utility>

#include "contact/complete.hpp"
#include "contact/dual_contact.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

/// Fluxes below this part of the forces that the data make are rounding.
constexpr double kNoStress = 1e-12;

}  // namespace

DualSolution::DualSolution(const CondensedProblem& base, const Quantity& quantity, Progress& progress)
    : base_(base),
      problem_(dual_problem(base.discretization().problem, quantity)),
      discretization_(problem_, base.discretization().mesh,
                      LoadProjection(problem_, base.discretization().mesh, &progress), &progress,
                      ClearanceOf::change),
      right_(assemble_right(discretization_, progress)),
      condensed_(*base.used_operator(), right_, progress),
      has_loads_(!quantity.has_no_loads()) {}

void DualSolution::solve(const Eigen::VectorXd& clearance, double factor, Progress& progress) {
  const DualContact contact =
      dual_contact(base_.contact(), clearance, condensed_.contact().c, factor, progress);
  Completed all = complete(discretization_, condensed_, contact.clearance, contact.open, progress);
  factor_ = factor;
  largest_factor_ = contact.largest_factor;
  coupling_ = std::move(all.coupling);
  clearance_ = contact.clearance;
  solution_.stress = std::move(all.fields.stress);
  // Where the weight is that of an open contact nothing is stressed, and what is left is rounding.
  if (!has_loads_ &&
      solution_.stress.lpNorm<Eigen::Infinity>() <= kNoStress * right_.lpNorm<Eigen::Infinity>())
    solution_.stress.setZero();
  solution_.displacement = std::move(all.fields.displacement);
  solution_.rotation = discretization_.traces.rotation(coupling_);
  const Eigen::VectorXd on_rows = discretization_.clearance.clearance(contact.clearance);
  solution_.summary.residuals =
      residuals(solution_, on_rows, Eigen::VectorXd::Zero(on_rows.size()), discretization_);
}

CertifiedSolution DualSolution::certified(const CertifiedSolution& base, double factor, const LawOnMesh& laws,
                                          Progress& progress) const {
  return {discretization_,
          solution_,
          dual_pair(discretization_, solution_, coupling_, base.pair, factor, progress),
          laws,
          progress,
          &base};
}

}  // namespace signorini
