#pragma once

#include <vector>

#include "fem/clearance_space.hpp"

namespace signorini {

/// One coefficient of the coupling: datum + sign · x[unknown].
struct CouplingDof {
  int unknown = -1;  ///< -1 where it is data
  int sign = 1;
  double datum = 0;

  /// sign · x[unknown].
  double part_of(const Eigen::VectorXd& x) const { return unknown < 0 ? 0 : sign * x[unknown]; }
};

/// Everything through which the triangles are coupled: the trace multiplier m of the displacement on every
/// edge and, for elasticity, the rotation γ at every point.
///
/// m is data on Γ_D (the projection of u_D) and free inside and on Γ_F. On Γ_C and rollers an elastic body's
/// m is split into its normal and its tangential component (on Γ_C along the contact's direction and across
/// it): the tangential one is free, which is σ_T = 0; the normal one is 0 on rollers and Πg − λ on Γ_C (for
/// the membrane, with u_n = −u, m = λ − Πg). The unknowns x are the free ones followed by the contact
/// unknowns λ, which come last: the Cholesky factorisation leaves them to the contact problem.
class TraceSpace {
 public:
  TraceSpace(const Problem& problem, const Mesh& mesh, const ClearanceSpace& clearance);

  int unknowns() const { return free_ + contact_; }
  int free_unknowns() const { return free_; }
  int contact_unknowns() const { return contact_; }
  /// The rotations among the free unknowns, their last.
  int rotations() const { return rotations_ ? static_cast<int>(mesh_.points.size()) : 0; }

  /// The degrees of freedom of a triangle: its traces in the order of its stress fluxes, then the rotation at
  /// its corners.
  int traces_per_triangle() const { return 3 * per_edge_; }
  int dofs_per_triangle() const { return 3 * per_edge_ + rotations_; }
  int dof(int triangle, int local) const {
    return triangle_dofs_[static_cast<std::size_t>(triangle) * dofs_per_triangle() + local];
  }
  const CouplingDof& operator[](int dof) const { return dofs_[dof]; }
  /// Neither data nor a clearance.
  bool is_free(int dof) const { return dofs_[dof].unknown >= 0 && dofs_[dof].unknown < free_; }

  /// True if an edge of the triangle carries normal and tangential components instead of x and y.
  bool is_turned(int triangle) const;
  /// Turns the normal and tangential components of a triangle's traces into x and y components, by columns;
  /// the transpose of the map turns fluxes the other way. Only for triangles that are turned.
  LocalMatrix to_xy(int triangle) const;

  /// The coefficients of the coupling on a triangle for the unknowns x, in x and y components.
  LocalVector values(int triangle, const Eigen::VectorXd& x) const;
  /// What the values change by if the unknowns change by dx.
  LocalVector changes(int triangle, const Eigen::VectorXd& dx) const;

  /// The rotation at every point; empty for a membrane.
  Eigen::VectorXd rotation(const Eigen::VectorXd& x) const;

  /// Takes the gaps of the clearance space as data; it differs in nothing else from the one before.
  void meet(const ClearanceSpace& clearance);

  /// The unknown of m on an edge for a function and a component, and of the rotation at a point.
  int trace_at(int edge, int function, int component) const {
    return dofs_[edge * per_edge_ + function * components_ + component].unknown;
  }
  int rotation_at(int point) const { return dofs_[first_rotation() + point].unknown; }

 private:
  void number_triangles();
  int dof_of(int triangle, int local) const;
  void fix(const BoundaryPart& part, const VectorField& value);
  void roll(const BoundaryPart& part, const SupportMotion& motion);
  void reserve_contact(const ClearanceSpace& clearance);
  void turn(int edge, const Vector& direction);
  /// Of numbers in the components that each edge carries.
  LocalVector in_xy(int triangle, const LocalVector& own) const;
  int first_rotation() const { return static_cast<int>(mesh_.edges.size()) * per_edge_; }
  CouplingDof& at(int edge, int function, int component) {
    return dofs_[edge * per_edge_ + function * components_ + component];
  }

  const Mesh& mesh_;
  int components_;
  int order_;
  int per_edge_;
  int rotations_;
  int free_ = 0;
  int contact_;
  std::vector<CouplingDof>
      dofs_;  ///< edge by edge, from the edge's first to its second point; then the points
  std::vector<int> triangle_dofs_;  ///< dofs_per_triangle() a triangle: every loop over triangles asks
  std::vector<Vector> directions_;  ///< of the first component on the turned edges
  std::vector<int> turned_;         ///< the index of each edge in directions_, or -1
};

}  // namespace signorini
