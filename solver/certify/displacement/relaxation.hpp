#pragma once

#include "certify/local_fields.hpp"
#include "certify/tensor.hpp"
#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// A quadratic function by its values at all points and in the middles of all edges, with those that may not
/// change.
struct QuadraticValues {
  explicit QuadraticValues(const Mesh& mesh);

  Quadratic<1> on(const Mesh& mesh, int t) const;
  /// Those on the edge and at its ends may not change.
  void hold(const Mesh& mesh, int edge);

  Eigen::VectorXd points, middles;  ///< 0 at first
  std::vector<bool> held_points, held_middles;
};

/// The work on each of the quadratic functions, first of the points, then of the middles: of load and
/// traction, (Πf, φ) + <t, φ>, and of a stress, (τ, ∇φ).
Eigen::VectorXd work_of_loads(const Discretization& discrete, Progress& progress);
Eigen::VectorXd work_of_stress(const Discretization& discrete, const StressField& tau);

/// The steps after which hardly anything is left of what an average has for error: that oscillates from
/// triangle to triangle. The bound of the nonconforming scheme falls by 40 %.
constexpr int kStepsFromAverage = 3;

/// E of a law, and for stream functions the tensor M with ‖∇Ψ‖_M = ‖curl Ψ‖_C: that is E / det E.
Eigen::Matrix2d stiffness_of(const Law<1>& law);
Eigen::Matrix2d turned_compliance_of(const Law<1>& law);

/// Lowers ½ ‖∇v‖²_M − work(v), where `modulus` is M of a law, by so many steps of the method of conjugate
/// gradients, scaled by the diagonal.
///
/// A modulus counts with its linear part on each triangle: linear_modulus(). With its value in the centroid
/// only, v is not one order better than u_h: the bound of the conforming scheme would double where the
/// modulus varies.
void relax(const Discretization& discrete, Eigen::Matrix2d (*modulus)(const Law<1>&), QuadraticValues& v,
           const Eigen::VectorXd& work, int steps, Progress& progress);

}  // namespace signorini
