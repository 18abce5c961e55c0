#include "certify/displacement/lift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

namespace signorini {
namespace {

constexpr int kInnerNodes = Lift::kDegree - 1;

double node(int i) {
  return (1 - std::cos(i * std::numbers::pi / Lift::kDegree)) / 2;
}

}  // namespace

Lift::Powers Lift::powers(double t) {
  Powers all;
  double power = 1;
  for (int k = 0; k < kCoefficients; ++k, power *= t - 0.5) all[k] = power;
  return all;
}

Lift::Powers Lift::slopes(double t) {
  Powers all = Powers::Zero();
  double power = 1;
  for (int k = 1; k < kCoefficients; ++k, power *= t - 0.5) all[k] = k * power;
  return all;
}

Lift::Lift(int components, const std::function<Eigen::VectorXd(double s)>& d)
    : coefficients_(components, kInnerNodes) {
  static const Eigen::Matrix<double, kInnerNodes, kInnerNodes> of_values = [] {
    Eigen::Matrix<double, kInnerNodes, kInnerNodes> all;
    for (int i = 0; i < kInnerNodes; ++i) all.row(i) = powers(node(i + 1)).transpose();
    return all.inverse().eval();
  }();
  Eigen::Matrix<double, Eigen::Dynamic, kInnerNodes> values(components, kInnerNodes);
  for (int i = 0; i < kInnerNodes; ++i) {
    const double s = node(i + 1);
    const Eigen::VectorXd own = d(s);
    largest_ = std::max(largest_, own.lpNorm<Eigen::Infinity>());
    values.col(i) = own / (s * (1 - s));
  }
  coefficients_ = values * of_values.transpose();
}

Eigen::VectorXd Lift::operator()(double s) const {
  return s * (1 - s) * (coefficients_ * powers(s));
}

Eigen::VectorXd Lift::value(double a, double b) const {
  return a * b * (2 - a - b) * (coefficients_ * powers((1 + b - a) / 2));
}

Eigen::Matrix<double, Eigen::Dynamic, 2> Lift::gradient(double a, double b, const Vector& gradient_a,
                                                        const Vector& gradient_b) const {
  const double t = (1 + b - a) / 2, factor = 2 - a - b;
  const Vector of_bubble = factor * (b * gradient_a + a * gradient_b) - a * b * (gradient_a + gradient_b);
  return coefficients_ * powers(t) * of_bubble.transpose() +
         a * b * factor * (coefficients_ * slopes(t)) * ((gradient_b - gradient_a) / 2).transpose();
}

const Lift::Errors& Lift::errors() {
  static const Errors all = [] {
    // Between the samples they change by less than the margin. At the ends ω is 0, and ω / 4 s (1 − s) is
    // |ω'| / 4.
    constexpr int samples = 4000;
    constexpr double margin = 1.002;
    Errors errors{};
    for (int i = 0; i <= samples; ++i) {
      const double s = 1. * i / samples;
      double omega = 1, slope = 0;
      for (int k = 0; k <= kDegree; ++k) {
        slope = slope * (s - node(k)) + omega;
        omega *= s - node(k);
      }
      errors.value = std::max(errors.value, margin * std::abs(omega));
      errors.slope = std::max(errors.slope, margin * std::abs(slope));
      const bool is_end = i == 0 || i == samples;
      const double over_bubble = is_end ? std::abs(slope) / 4 : std::abs(omega) / (4 * s * (1 - s));
      errors.over_bubble = std::max(errors.over_bubble, margin * over_bubble);
    }
    return errors;
  }();
  return all;
}

}  // namespace signorini
