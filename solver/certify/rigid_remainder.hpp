#pragma once

#include <array>

#include "problem/field.hpp"

namespace signorini {

/// The least constant in min ‖w − r‖ ≤ constant · ‖ε(w)‖ on a triangle, for all w and over the rigid motions
/// r; a bound of it from above.
///
/// An affine map x = B x̂ + b takes w to ŵ = Bᵀ w on a reference triangle. There ε(ŵ) = Bᵀ ε(w) B, and rigid
/// motions are again such: with the constant Ĉ of the reference triangle this one is at most Ĉ ‖B‖² ‖B⁻¹‖.
double rigid_remainder(const std::array<Point, 3>& corners);

/// The same for ‖w − r‖ on local edge e: at most Ĉ_e ‖B‖² ‖B⁻¹‖ √(|e| / |ê| det B).
double rigid_remainder_on_edge(const std::array<Point, 3>& corners, int e);

/// A triangle whose constants are known. Let C₁ be the largest norm of the least stress in equilibrium with a
/// load of norm 1 that is a rigid motion on each of the 4ⁿ triangles into which it is cut n times. What a
/// load has beyond its part of that kind counts on each of them with the constant C / 2ⁿ, for they are
/// similar. Hence C² ≤ C₁² + C² / 4ⁿ, and C² ≤ C₁² / (1 − 4⁻ⁿ). In the same way C² ≤ C₁² / (1 − 2⁻ⁿ) for
/// tractions on an edge that are linear on its pieces. A test computes both for n = 3.
struct ReferenceTriangle {
  std::array<Point, 3> corners;
  double constant;
  std::array<double, 3> on_edges;
};

/// Half a unit square, and the triangle with three unit sides.
const std::array<ReferenceTriangle, 2>& reference_triangles();

}  // namespace signorini
