#include "system/recovery.hpp"

#include <cmath>

#include "fem/per_shape.hpp"
#include "system/elimination.hpp"

namespace signorini {
namespace {

/// Takes the forces of one triangle off the right side of the unknowns that they act on.
void subtract_forces(const TraceSpace& traces, int triangle, LocalVector force, Eigen::VectorXd& right) {
  if (traces.is_turned(triangle)) force = (traces.to_xy(triangle).transpose() * force).eval();
  for (int j = 0; j < force.size(); ++j) {
    const CouplingDof& dof = traces[traces.dof(triangle, j)];
    if (dof.unknown >= 0) right[dof.unknown] -= dof.sign * force[j];
  }
}

}  // namespace

Recovered recover(const Discretization& problem, const Eigen::VectorXd& x, Progress& progress) {
  const TraceSpace& traces = problem.traces;
  Recovered all{Eigen::MatrixXd(problem.spaces().stresses(), problem.triangles()),
                Eigen::MatrixXd(problem.spaces().displacements(), problem.triangles()),
                problem.coupling_load};
  PerShape<Elimination> eliminations(problem);
  for (int t = 0; t < problem.triangles(); ++t) {
    progress.check_in(t);
    const Elimination& elimination = eliminations(
        t, [&](const ElementMatrices& matrices) { return Elimination(matrices, problem.spaces()); });
    const LocalFields local =
        elimination.recover(traces.values(t, x), problem.load.col(t), [&](const LocalVector& stress) {
          return problem.element.strain(problem.mesh, t, elimination.compliance(), stress);
        });
    all.stress.col(t) = local.stress;
    all.displacement.col(t) = local.displacement;
    subtract_forces(traces, t, local.force, all.imbalance);
    const double flux = local.force.head(traces.traces_per_triangle()).lpNorm<Eigen::Infinity>();
    const double length = std::sqrt(AffineMap(problem.mesh.corners(t)).determinant);
    all.largest_flux = std::max(all.largest_flux, flux);
    all.largest_moment = std::max(all.largest_moment, flux * length);
  }
  return all;
}

bool Recovered::is_balanced(const TraceSpace& traces) const {
  constexpr double rounding = 1e-13;
  const int first_rotation = traces.free_unknowns() - traces.rotations();
  const double forces = imbalance.head(first_rotation).lpNorm<Eigen::Infinity>();
  const double moments = imbalance.segment(first_rotation, traces.rotations()).lpNorm<Eigen::Infinity>();
  return forces <= rounding * largest_flux && moments <= rounding * largest_moment;
}

void change(const Discretization& problem, const Eigen::VectorXd& dx, Recovered& fields, Progress& progress) {
  fields.imbalance = problem.coupling_load;
  PerShape<Elimination> eliminations(problem);
  for (int t = 0; t < problem.triangles(); ++t) {
    progress.check_in(t);
    const Elimination& elimination = eliminations(
        t, [&](const ElementMatrices& matrices) { return Elimination(matrices, problem.spaces()); });
    const LocalVector lack = -problem.load.col(t) - problem.spaces().divergence * fields.stress.col(t);
    const LocalFields local = elimination.respond(problem.traces.changes(t, dx), lack);
    fields.stress.col(t) += local.stress;
    fields.displacement.col(t) += local.displacement;
    subtract_forces(problem.traces, t, elimination.force(fields.stress.col(t)), fields.imbalance);
  }
}

}  // namespace signorini
