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

Recovered recover(const Discretization& discrete, const Eigen::VectorXd& x, Progress& progress) {
  const TraceSpace& traces = discrete.traces;
  Recovered all{Eigen::MatrixXd(discrete.spaces().stresses(), discrete.triangles()),
                Eigen::MatrixXd(discrete.spaces().displacements(), discrete.triangles()),
                discrete.coupling_load};
  struct Shape {
    Elimination elimination;
    StrainMoments strain;
  };
  PerShape<Shape> shapes(discrete);
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    const Shape& shape = shapes(t, [&](const ElementMatrices& matrices) -> Shape {
      return {Elimination(matrices, discrete.spaces()),
              discrete.element.strain_moments(discrete.mesh, t, matrices.compliance)};
    });
    const LocalFields local =
        shape.elimination.recover(traces.values(t, x), discrete.load.col(t), shape.strain);
    all.stress.col(t) = local.stress;
    all.displacement.col(t) = local.displacement;
    subtract_forces(traces, t, local.force, all.imbalance);
    const double flux = local.force.head(traces.traces_per_triangle()).lpNorm<Eigen::Infinity>();
    const double length = std::sqrt(AffineMap(discrete.mesh.corners(t)).determinant);
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

void change(const Discretization& discrete, const Eigen::VectorXd& dx, Recovered& fields,
            Progress& progress) {
  fields.imbalance = discrete.coupling_load;
  PerShape<Elimination> eliminations(discrete);
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    const Elimination& elimination = eliminations(
        t, [&](const ElementMatrices& matrices) { return Elimination(matrices, discrete.spaces()); });
    const LocalVector lack = -discrete.load.col(t) - discrete.spaces().divergence * fields.stress.col(t);
    const LocalFields local = elimination.respond(discrete.traces.changes(t, dx), lack);
    fields.stress.col(t) += local.stress;
    fields.displacement.col(t) += local.displacement;
    subtract_forces(discrete.traces, t, elimination.force(fields.stress.col(t)), fields.imbalance);
  }
}

}  // namespace signorini
