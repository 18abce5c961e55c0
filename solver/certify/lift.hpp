#pragma once

#include <functional>

#include <Eigen/Core>

#include "problem/field.hpp"

namespace signorini {

/// A function d on an edge that vanishes at both ends, and its extension into the triangle that vanishes on
/// the two other edges: with the barycentric coordinates λ_a, λ_b of the ends of the edge
///
///     w = ρ d(s),   ρ = λ_a + λ_b,   s = λ_b / ρ.
///
/// d is kept as its polynomial of degree 12 in the Chebyshev points.
class Lift {
 public:
  static constexpr int size = 13;

  /// d(s) for s ∈ [0, 1] with the given number of components; taken as 0 at both ends.
  Lift(int components, const std::function<Eigen::VectorXd(double s)>& d);

  /// max |d| in the points of the polynomial.
  double largest() const { return values_.size() ? values_.cwiseAbs().maxCoeff() : 0; }
  /// max |d − polynomial| half-way between them.
  double interpolation_error() const { return interpolation_error_; }

  Eigen::VectorXd operator()(double s) const;
  Eigen::VectorXd derivative(double s) const;

  /// w for given λ_a, λ_b, and its gradient for given ∇λ_a, ∇λ_b: row c of component c.
  Eigen::VectorXd value(double a, double b) const;
  Eigen::Matrix<double, Eigen::Dynamic, 2> gradient(double a, double b, const Vector& gradient_a,
                                                    const Vector& gradient_b) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, size> values_;
  double interpolation_error_ = 0;
};

}  // namespace signorini
