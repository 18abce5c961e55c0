#pragma once

#include <array>
#include <functional>

#include <Eigen/Core>

#include "problem/field.hpp"

namespace signorini {

/// Matrices of one triangle, on the stack: at most the 16 functions of two RT1 rows.
constexpr int kMaxLocal = 16;
using LocalMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLocal, kMaxLocal>;
using LocalVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLocal, 1>;
using LocalVectors = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxLocal>;

/// The affine map x = a + J x̂ from the reference triangle (0,0), (1,0), (0,1) onto a triangle that runs
/// counter-clockwise.
struct AffineMap {
  explicit AffineMap(const std::array<Point, 3>& corners) : origin(corners[0]) {
    jacobian.col(0) = corners[1] - origin;
    jacobian.col(1) = corners[2] - origin;
    determinant = jacobian(0, 0) * jacobian(1, 1) - jacobian(1, 0) * jacobian(0, 1);
  }

  Point operator()(const Point& reference) const { return origin + jacobian * reference; }

  Point origin;
  Eigen::Matrix2d jacobian;
  double determinant;  ///< twice the area
};

/// The Raviart–Thomas element RT_k with P_k normal traces (k = 0: 3 functions, k = 1: 8), after Boffi,
/// Brezzi, Fortin, Mixed Finite Element Methods and Applications, section 2.3.1.
///
/// Its functionals, in this order: on edge e = 0, 1, 2 (opposite vertex e, from vertex a = e+1 to
/// b = e+2) the outward flux ∫ τ·n φ against the basis of P_k on the edge: φ = 1 for k = 0; φ_a, φ_b (1 at
/// its own end, 0 at the other) for k = 1; then, for k = 1, ∫ τ_x and ∫ τ_y over the reference triangle.
/// Function j is 1 in functional j and 0 in all others. A row of PEERS (Arnold, Brezzi, Douglas 1984) has one
/// more function behind them, the curl (∂_y b, −∂_x b) of the cubic bubble b = 27 λ₀ λ₁ λ₂, which has neither
/// flux nor divergence. The Piola map τ(x) = J τ̂(x̂) / det J keeps fluxes,
/// and so div τ = div τ̂ / det J.
class RaviartThomas {
 public:
  explicit RaviartThomas(int order, bool with_bubble = false);

  int order() const { return order_; }
  int size() const { return (order_ == 0 ? 3 : 8) + (with_bubble_ ? 1 : 0); }
  int functions_per_edge() const { return order_ + 1; }
  int edge_functions() const { return 3 * functions_per_edge(); }

  /// Column j: function j at a point of the reference triangle.
  LocalVectors reference_values(const Point& reference) const;
  /// Entry j: the divergence of function j on the reference triangle.
  LocalVector reference_divergences(const Point& reference) const;
  /// Column j: function j on the triangle at the image of the reference point.
  LocalVectors values(const AffineMap& map, const Point& reference) const;

  /// The functionals of a field on the triangle: the coefficients of its interpolant, which is the field
  /// itself if it lies in RT_k. Not for a row with a bubble.
  LocalVector interpolate(const AffineMap& map, const std::function<Vector(const Point& x)>& field) const;

 private:
  /// By columns, the functionals of fields on the reference triangle.
  template <typename Fields>
  LocalMatrix functionals(int fields, const Fields& values) const;

  int order_;
  bool with_bubble_;
  LocalMatrix coefficients_;  ///< column j: function j in the monomials
};

}  // namespace signorini
