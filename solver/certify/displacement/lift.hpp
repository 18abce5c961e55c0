#pragma once

#include <functional>

#include <Eigen/Core>

#include "problem/field.hpp"

namespace signorini {

/// A function d on an edge that vanishes at both ends, a polynomial of degree 8 in s, and its extension into
/// the triangle that vanishes on the two other edges: with the barycentric coordinates λ_a, λ_b of the ends
/// of the edge
///
///     w = λ_a λ_b (1 + λ_c) q(t),   t = (1 + λ_b − λ_a) / 2,   d(s) = s (1 − s) q(s),
///
/// a polynomial of degree 9; on the edge t = s and λ_c = 0. The factor 1 + λ_c makes it close to a function
/// that is homogeneous around the corner across: 1 / (λ_a + λ_b) ≈ 1 + λ_c.
class Lift {
 public:
  static constexpr int kDegree = 8;  ///< of d
  static constexpr int kDegreeInside = kDegree + 1;

  /// Interpolates d(s), s ∈ [0, 1], with the given number of components, in the Chebyshev points (extrema);
  /// it is taken as 0 at both ends.
  Lift(int components, const std::function<Eigen::VectorXd(double s)>& d);

  /// max |d| in the points.
  double largest() const { return largest_; }
  Eigen::VectorXd operator()(double s) const;

  /// w for given λ_a, λ_b, and its gradient for given ∇λ_a, ∇λ_b: row c of component c.
  Eigen::VectorXd value(double a, double b) const;
  Eigen::Matrix<double, Eigen::Dynamic, 2> gradient(double a, double b, const Vector& gradient_a,
                                                    const Vector& gradient_b) const;

  /// What the interpolant of f is off by is at most max |f⁽⁹⁾|/9! times these: itself max |ω|, its slope max
  /// |ω'| (Shadrin 1995), itself over 4 s (1 − s) the last; ω(s) = Π (s − s_i).
  struct Errors {
    double value, slope, over_bubble;
  };
  static const Errors& errors();

 private:
  static constexpr int kCoefficients = kDegree - 1;
  using Powers = Eigen::Matrix<double, kCoefficients, 1>;
  static Powers powers(double t);
  static Powers slopes(double t);

  Eigen::Matrix<double, Eigen::Dynamic, kCoefficients> coefficients_;  ///< of q in t − 1/2
  double largest_ = 0;
};

}  // namespace signorini
