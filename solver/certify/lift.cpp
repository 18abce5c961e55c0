#include "certify/lift.hpp"

#include <cmath>
#include <numbers>

namespace signorini {
namespace {

using Nodal = Eigen::Matrix<double, Lift::size, 1>;

double node(double i) {
  return (1 - std::cos(i * std::numbers::pi / (Lift::size - 1))) / 2;
}

/// The weights of barycentric interpolation in Chebyshev points (Berrut, Trefethen 2004, eq. 5.4).
double weight(int i) {
  const double half = i == 0 || i == Lift::size - 1 ? 0.5 : 1;
  return i % 2 == 0 ? half : -half;
}

Nodal all_nodes() {
  Nodal nodes;
  for (int i = 0; i < Lift::size; ++i) nodes[i] = node(i);
  return nodes;
}

/// The Lagrange polynomials at s.
Nodal lagrange(double s) {
  static const Nodal nodes = all_nodes();
  Nodal values;
  for (int i = 0; i < Lift::size; ++i) {
    if (s == nodes[i]) return Nodal::Unit(i);
    values[i] = weight(i) / (s - nodes[i]);
  }
  return values / values.sum();
}

/// The derivatives of the Lagrange polynomials in the nodes (Berrut, Trefethen 2004, eq. 9.4, 9.5), row by
/// node.
Eigen::Matrix<double, Lift::size, Lift::size> differentiation() {
  Eigen::Matrix<double, Lift::size, Lift::size> d = decltype(d)::Zero();
  for (int i = 0; i < Lift::size; ++i)
    for (int j = 0; j < Lift::size; ++j) {
      if (i == j) continue;
      d(i, j) = weight(j) / weight(i) / (node(i) - node(j));
      d(i, i) -= d(i, j);
    }
  return d;
}

}  // namespace

Lift::Lift(int components, const std::function<Eigen::VectorXd(double s)>& d) : values_(components, size) {
  values_.setZero();
  for (int i = 1; i + 1 < size; ++i) values_.col(i) = d(node(i));
  for (int i = 0; i + 1 < size; ++i) {
    const double s = node(i + 0.5);
    interpolation_error_ = std::max(interpolation_error_, ((*this)(s)-d(s)).lpNorm<Eigen::Infinity>());
  }
}

Eigen::VectorXd Lift::operator()(double s) const {
  return values_ * lagrange(s);
}

Eigen::VectorXd Lift::derivative(double s) const {
  static const Eigen::Matrix<double, size, size> differentiate = differentiation();
  return values_ * (differentiate.transpose() * lagrange(s));
}

Eigen::VectorXd Lift::value(double a, double b) const {
  const double rho = a + b;
  return rho * (*this)(b / rho);
}

Eigen::Matrix<double, Eigen::Dynamic, 2> Lift::gradient(double a, double b, const Vector& gradient_a,
                                                        const Vector& gradient_b) const {
  const double s = b / (a + b);
  const Eigen::VectorXd d = (*this)(s), slope = derivative(s);
  return (d - s * slope) * (gradient_a + gradient_b).transpose() + slope * gradient_b.transpose();
}

}  // namespace signorini
