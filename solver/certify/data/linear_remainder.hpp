#pragma once

#include <array>

#include "problem/field.hpp"

namespace signorini {

/// A triangle as the image of a reference triangle: x = x₀ + B x̂ takes corner z of that one to corner
/// first + z.
struct ReferenceMap {
  int reference = 0;  ///< of reference_triangles()
  int first = 0;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();  ///< B
  double stretch = 0;                                      ///< ‖B‖
};

/// The one of the six maps with the least constant of linear_remainder().
template <int D>
ReferenceMap nearest_reference(const std::array<Point, 3>& corners);

/// A bound from above of the least constant in min ‖w − p‖ ≤ constant · ‖ε(w)‖ on a triangle, for all
/// displacements w of D components (∇w for ε(w) if there is one) and over the linear p. It bounds (f, w) for
/// the loads f of norm 1 that are orthogonal to all linear functions, and is the largest norm of the least
/// stress in equilibrium with such a load.
///
/// An affine map x = B x̂ + b takes w to ŵ = Bᵀ w on a reference triangle, where ε(ŵ) = Bᵀ ε(w) B: with the
/// constant Ĉ of the reference triangle this one is at most Ĉ ‖B‖² ‖B⁻¹‖. For a membrane it is at most Ĉ ‖B‖.
template <int D>
double linear_remainder(const std::array<Point, 3>& corners);

/// The same for ‖w − p‖ on local edge e, and so for tractions there that are orthogonal to the linear ones:
/// at most Ĉ_e √(|e| / |ê| det B) times the same norms.
template <int D>
double linear_remainder_on_edge(const std::array<Point, 3>& corners, int e);

/// What a displacement w has beyond a rigid motion R_T w, of a membrane a constant, that depends on it
/// linearly: ‖w − R_T w‖ ≤ constant · ‖ε(w)‖ on the triangle and on its local edges. R_T is the projection in
/// L2 of the reference triangle, brought back by w = B⁻ᵀ ŵ, which takes rigid motions to such.
struct MotionRemainder {
  double on_triangle;
  std::array<double, 3> on_edges;
};
template <int D>
MotionRemainder motion_remainder(const std::array<Point, 3>& corners);

/// Constants of a reference triangle. Let C₁ be that of the loads which are linear on each of the 4ⁿ
/// triangles into which it is cut n times. What a load has beyond its part of that kind counts on each of
/// them with the constant C / 2ⁿ, for they are similar. Hence C² ≤ C₁² + C² / 4ⁿ, and C² ≤ C₁² / (1 − 4⁻ⁿ).
/// In the same way C² ≤ C₁² / (1 − 2⁻ⁿ) for tractions on an edge that are linear on its pieces. Those of
/// motion_remainder() are at most the roots of M₁² + C² / 4ⁿ and M₁² + C² / 2ⁿ. A test computes all for n
/// = 3.
struct ReferenceConstants {
  double load;
  std::array<double, 3> on_edges;
  MotionRemainder motion;
};

struct ReferenceTriangle {
  std::array<Point, 3> corners;
  ReferenceConstants membrane, elastic_body;

  const ReferenceConstants& constants(int components) const {
    return components == 1 ? membrane : elastic_body;
  }
};

/// Half a unit square, and the triangle with three unit sides.
const std::array<ReferenceTriangle, 2>& reference_triangles();

}  // namespace signorini
