#pragma once

#include <array>

#include "fem/quadrature.hpp"
#include "fem/scheme.hpp"
#include "mesh/mesh.hpp"
#include "problem/material.hpp"

namespace signorini {

/// The forms of Problem 4.1 on one triangle, in the bases of the spaces. Where the material is constant they
/// depend on the triangle's shape alone.
struct ElementMatrices {
  LocalMatrix compliance;         ///< M = (C τ_i, τ_j)
  LocalMatrix displacement_mass;  ///< V = (v_i, v_j)
  LocalMatrix skew;               ///< A = (τ_xy − τ_yx, φ_z), a row a corner; no rows for a membrane
};

/// (C σ, τ_j) for stresses in the basis of the spaces on one triangle: M σ, but with the digits that the
/// entries of M lose where the volume is stiff.
struct StrainMoments {
  LocalVector operator()(const LocalVector& stress) const;

  /// At the points of the rule the mean of σ_xx and σ_yy, half their difference, σ_xy and σ_yx; and what the
  /// products of these count in the form. None of a body that is not isotropic.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 4 * TriangleRule::size, kMaxLocal>
      values;
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 4 * TriangleRule::size> moduli;
  LocalMatrix compliance;  ///< M of such a body
};

/// What the body load does to one triangle.
struct TriangleLoad {
  LocalVector force;  ///< F = (f, v_i)
  double couple = 0;  ///< of an elastic body: ∫ (x − x_T)^⊥ · f about the centroid x_T
};

/// Computes the matrices and loads of the triangles of a problem: C is the compliance of its material.
///
/// Where the material is constant the integrals over the reference triangle are taken once and each triangle
/// combines them; elsewhere C is evaluated at the seven points of the rule.
class Element {
 public:
  explicit Element(const Problem& problem);

  ElementMatrices matrices(const Mesh& mesh, int triangle) const;
  /// Of the load that is quadratic on the triangle, a row a component: its values at the nodes of P2.
  TriangleLoad load(const Mesh& mesh, int triangle, const Eigen::Ref<const Eigen::MatrixXd>& quadratic) const;
  LocalMatrix stress_mass(const Mesh& mesh, int triangle) const;  ///< (τ_i, τ_j)
  bool has_constant_material() const { return constant_material_; }
  /// `compliance`: M.
  StrainMoments strain_moments(const Mesh& mesh, int triangle, const LocalMatrix& compliance) const;
  const Spaces& spaces() const { return spaces_; }

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 9, 9>;

  LocalMatrix constant_form(const AffineMap& map, const Compliance& compliance) const;
  LocalMatrix varying_compliance(const AffineMap& map) const;
  LocalMatrix skew(const AffineMap& map) const;

  const Problem& problem_;
  const Spaces& spaces_;
  bool constant_material_;
  Compliance compliance_;                             ///< C, if constant
  std::array<LocalVectors, TriangleRule::size> tau_;  ///< τ̂_a of one row at the points of the rule
  /// (φ, v_i) over the reference triangle with the basis φ of P2 and scalar v_i; ∫ φ (x − its centroid).
  Eigen::Matrix<double, 6, Eigen::Dynamic> of_loads_;
  Eigen::Matrix<double, 6, 2> arms_of_loads_ = Eigen::Matrix<double, 6, 2>::Zero();
  RowMatrix moments_[2][2];                  ///< ∫ τ̂_k τ̂_lᵀ for the components k, l of a row
  std::array<LocalVectors, 3> hat_moments_;  ///< ∫ φ_z τ̂_a for the corners z
};

}  // namespace signorini
