#include "system/recovery.hpp"

#include <cmath>

#include "fem/per_shape.hpp"
#include "progress/in_parts.hpp"
#include "system/elimination.hpp"

namespace signorini {
namespace {

/// The forces of the triangles of a part of the mesh on their unknowns.
class Forces {
 public:
  Forces(const TraceSpace& traces, Part part)
      : traces_(traces), part_(part), all_(traces.dofs_per_triangle(), part.end - part.begin) {}

  void set(int triangle, const LocalVector& force) {
    all_.col(triangle - part_.begin) =
        traces_.is_turned(triangle) ? LocalVector(traces_.to_xy(triangle).transpose() * force) : force;
  }

  void subtract_from(Eigen::VectorXd& right) const {
    for (int t = part_.begin; t < part_.end; ++t)
      for (int j = 0; j < all_.rows(); ++j) {
        const CouplingDof& dof = traces_[traces_.dof(t, j)];
        if (dof.unknown >= 0) right[dof.unknown] -= dof.sign * all_(j, t - part_.begin);
      }
  }

 private:
  const TraceSpace& traces_;
  Part part_;
  Eigen::MatrixXd all_;
};

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
  struct Found {
    Forces forces;
    double largest_flux = 0, largest_moment = 0;
  };
  const auto find = [&](Part part, Progress& own) {
    Found found{{traces, part}};
    PerShape<Shape> shapes(discrete);
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      const Shape& shape = shapes(t, [&](const ElementMatrices& matrices) -> Shape {
        return {Elimination(matrices, discrete.spaces()),
                discrete.element.strain_moments(discrete.mesh, t, matrices.compliance)};
      });
      const LocalFields local =
          shape.elimination.recover(traces.values(t, x), discrete.load.col(t), shape.strain);
      all.stress.col(t) = local.stress;
      all.displacement.col(t) = local.displacement;
      found.forces.set(t, local.force);
      const double flux = local.force.head(traces.traces_per_triangle()).lpNorm<Eigen::Infinity>();
      const double length = std::sqrt(AffineMap(discrete.mesh.corners(t)).determinant);
      found.largest_flux = std::max(found.largest_flux, flux);
      found.largest_moment = std::max(found.largest_moment, flux * length);
    }
    return found;
  };
  in_parts(discrete.triangles(), progress, find, [&](const Found& found) {
    found.forces.subtract_from(all.imbalance);
    all.largest_flux = std::max(all.largest_flux, found.largest_flux);
    all.largest_moment = std::max(all.largest_moment, found.largest_moment);
  });
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
  const auto find = [&](Part part, Progress& own) {
    Forces forces(discrete.traces, part);
    PerShape<Elimination> eliminations(discrete);
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      const Elimination& elimination = eliminations(
          t, [&](const ElementMatrices& matrices) { return Elimination(matrices, discrete.spaces()); });
      const LocalVector lack = -discrete.load.col(t) - discrete.spaces().divergence * fields.stress.col(t);
      const LocalFields local = elimination.respond(discrete.traces.changes(t, dx), lack);
      fields.stress.col(t) += local.stress;
      fields.displacement.col(t) += local.displacement;
      forces.set(t, elimination.force(fields.stress.col(t)));
    }
    return forces;
  };
  in_parts(discrete.triangles(), progress, find,
           [&](const Forces& forces) { forces.subtract_from(fields.imbalance); });
}

}  // namespace signorini
