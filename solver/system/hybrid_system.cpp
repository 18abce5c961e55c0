#include "system/hybrid_system.hpp"

#include <span>

#include "fem/per_shape.hpp"
#include "system/elimination.hpp"

namespace signorini {
namespace {

/// What the elimination of a triangle shape gives.
struct Shape {
  LocalMatrix stiffness;      ///< K
  LocalMatrix coupling_load;  ///< Q, so that q = Q F
};

Shape eliminate(const ElementMatrices& matrices, const Spaces& spaces) {
  const Elimination elimination(matrices, spaces);
  return {elimination.stiffness(), elimination.coupling_load()};
}

/// The same with the number that its stiffness has in the sum, and those of the last that were turned: along
/// a side triangles of the same shape have the same.
struct NumberedShape {
  Shape shape;
  int number;
  std::vector<int> turned;
};

/// The degrees of freedom of one triangle, datum + sign · x[unknown], in the normal and tangential components
/// of its edges where it has them.
class Dofs {
 public:
  Dofs(const TraceSpace& traces, int triangle)
      : traces_(traces), triangle_(triangle), datum_(traces.dofs_per_triangle()), sign_(datum_.size()) {
    for (int j = 0; j < datum_.size(); ++j) {
      const CouplingDof& dof = traces[traces.dof(triangle, j)];
      unknowns_[j] = dof.unknown;
      datum_[j] = dof.datum;
      sign_[j] = dof.sign;
    }
  }

  std::span<const int> unknowns() const {
    return std::span(unknowns_).first(static_cast<std::size_t>(datum_.size()));
  }
  bool has_data() const { return !datum_.isZero(0); }
  /// Whether x and y components are the unknowns themselves, but for the data.
  bool are_plain() const { return !traces_.is_turned(triangle_) && (sign_.array() == 1).all(); }

  /// A stiffness in x and y components as the unknowns see it.
  LocalMatrix turned(const LocalMatrix& stiffness) const {
    return turning().transpose() * stiffness * turning();
  }

  /// Adds a load in x and y components, and what the data exert through the stiffness.
  void add_load(LocalVector load, const LocalMatrix& stiffness, Eigen::VectorXd& right) const {
    if (has_data())
      load -= traces_.is_turned(triangle_) ? LocalVector(stiffness * (traces_.to_xy(triangle_) * datum_))
                                           : LocalVector(stiffness * datum_);
    add(load, right);
  }

  /// Adds forces in x and y components.
  void add(LocalVector forces, Eigen::VectorXd& right) const {
    if (!are_plain()) forces = (turning().transpose() * forces).eval();
    for (int j = 0; j < forces.size(); ++j)
      if (unknowns_[j] >= 0) right[unknowns_[j]] += forces[j];
  }

 private:
  LocalMatrix turning() const {
    const Eigen::Index n = sign_.size();
    const LocalMatrix map =
        traces_.is_turned(triangle_) ? traces_.to_xy(triangle_) : LocalMatrix(LocalMatrix::Identity(n, n));
    return map * sign_.asDiagonal();
  }

  const TraceSpace& traces_;
  int triangle_;
  std::array<int, kMaxLocal> unknowns_;
  LocalVector datum_, sign_;
};

}  // namespace

HybridSystem assemble(const Discretization& discrete, Progress& progress) {
  HybridSystem system;
  ElementSum& sum = system.matrix;
  sum.size = discrete.traces.unknowns();
  sum.per_element = discrete.traces.dofs_per_triangle();
  const auto triangles = static_cast<std::size_t>(discrete.triangles());
  sum.unknowns.reserve(triangles * static_cast<std::size_t>(sum.per_element));
  sum.matrix_of.reserve(triangles);
  sum.centres.reserve(triangles);
  system.right = discrete.coupling_load;
  PerShape<NumberedShape> shapes(discrete);
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    NumberedShape& numbered = shapes(t, [&](const ElementMatrices& matrices) -> NumberedShape {
      const Shape made = eliminate(matrices, discrete.spaces());
      return {made, sum.keep(made.stiffness.data()), {}};
    });
    const Shape& shape = numbered.shape;
    const Dofs dofs(discrete.traces, t);
    sum.unknowns.insert(sum.unknowns.end(), dofs.unknowns().begin(), dofs.unknowns().end());
    sum.matrix_of.push_back(
        dofs.are_plain() ? numbered.number : sum.keep(dofs.turned(shape.stiffness).data(), numbered.turned));
    sum.centres.push_back(discrete.mesh.centroid(t));
    dofs.add_load(shape.coupling_load.lazyProduct(discrete.load.col(t)), shape.stiffness, system.right);
  }
  return system;
}

Eigen::VectorXd assemble_right(const Discretization& discrete, Progress& progress) {
  Eigen::VectorXd right = discrete.coupling_load;
  PerShape<Shape> shapes(discrete);
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    const Dofs dofs(discrete.traces, t);
    const LocalVector load = discrete.load.col(t);
    if (!dofs.has_data() && load.isZero(0)) continue;
    const Shape& shape =
        shapes(t, [&](const ElementMatrices& matrices) { return eliminate(matrices, discrete.spaces()); });
    dofs.add_load(shape.coupling_load.lazyProduct(load), shape.stiffness, right);
  }
  return right;
}

void add_forces(const Discretization& discrete, int triangle, const LocalVector& coupling,
                Eigen::VectorXd& forces) {
  const Elimination elimination(discrete.element.matrices(discrete.mesh, triangle), discrete.spaces());
  Dofs(discrete.traces, triangle).add(elimination.stiffness() * coupling, forces);
}

}  // namespace signorini
