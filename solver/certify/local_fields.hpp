#pragma once

#include <array>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>

#include "certify/tensor.hpp"
#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "fem/scheme.hpp"

namespace signorini {

/// σ_h at given points of the reference triangle.
template <int D>
class StressValues {
 public:
  StressValues(const Spaces& spaces, const std::vector<Point>& points) : functions_(spaces.row.size()) {
    for (const Point& point : points) tau_.push_back(spaces.row.reference_values(point));
  }

  int functions() const { return functions_; }
  /// σ_h at point q. `coefficients`: of one triangle, function by function, the rows of a function together.
  template <typename Coefficients>
  Tensor<D> operator()(int q, const AffineMap& map, const Coefficients& coefficients) const {
    Tensor<D> value;
    for (int c = 0; c < D; ++c) {
      Vector sum = Vector::Zero();
      for (int a = 0; a < functions_; ++a) sum += coefficients[a * D + c] * tau_[q].col(a);
      value.template segment<2>(2 * c) = map.jacobian * sum / map.determinant;
    }
    return value;
  }

 private:
  int functions_;
  std::vector<LocalVectors> tau_;
};

/// The points of the triangle rule.
std::vector<Point> triangle_points();

/// Column q: the weights with which values at the points of the triangle rule give the corner values of their
/// L2 projection onto P1.
using CornerWeights = Eigen::Matrix<double, 3, TriangleRule::size>;
CornerWeights corner_weights();

/// A modulus as a linear function on a triangle, by its values at the corners: nearest in L2 to the one that
/// is known in the points of the rule. Where a modulus jumps, what is nearest may be negative in a corner,
/// and an energy with it has no minimum: then it is the mean.
template <typename Matrix>
std::array<Matrix, 3> linear_modulus(const std::array<Matrix, TriangleRule::size>& at_points) {
  constexpr double least = 0.05;  // of the mean
  static const CornerWeights weights = corner_weights();
  std::array<Matrix, 3> corners;
  for (int z = 0; z < 3; ++z) {
    corners[z].setZero();
    for (int q = 0; q < TriangleRule::size; ++q) corners[z] += weights(z, q) * at_points[q];
  }
  const Matrix mean = (corners[0] + corners[1] + corners[2]) / 3;
  for (const Matrix& corner : corners)
    if (Eigen::LLT<Matrix>(corner - least * mean).info() != Eigen::Success) return {mean, mean, mean};
  return corners;
}

/// A function of P2 on a triangle with values in D components: column k < 3 its value at corner k, column
/// 3 + e its value at the middle of local edge e.
template <int D>
using Quadratic = Eigen::Matrix<double, D, 6>;

/// A bound of the values on the triangle: the functions of P2 add up to at most 5/3 in absolute value.
template <typename Nodes>
double bound_of_quadratic(const Nodes& nodes) {
  return 5. / 3 * nodes.colwise().norm().maxCoeff();
}

/// A linear function at the nodes of P2, from its values at the corners.
template <int D>
Quadratic<D> at_nodes(const Eigen::Matrix<double, D, 3>& corners) {
  Quadratic<D> nodes;
  nodes << corners, (corners.col(1) + corners.col(2)) / 2, (corners.col(2) + corners.col(0)) / 2,
      (corners.col(0) + corners.col(1)) / 2;
  return nodes;
}

/// The gradients of the six functions of P2 at a point of the reference triangle, by columns.
Eigen::Matrix<double, 2, 6> quadratic_gradients(const Point& reference);
/// The gradients at the points of the triangle rule.
const std::array<Eigen::Matrix<double, 2, 6>, TriangleRule::size>& quadratic_gradients();

/// A stress of a membrane on a triangle, a column a point of the triangle rule.
using StressAtPoints = Eigen::Matrix<double, 2, TriangleRule::size>;
using StressField = std::function<StressAtPoints(int t)>;

/// The gradient, row by row, of a function on the triangle with the given reference gradients (row c: of
/// component c).
template <int D>
Tensor<D> gradient(const Eigen::Matrix2d& inverse_jacobian, const Eigen::Matrix<double, D, 2>& reference) {
  Tensor<D> tensor;
  for (int c = 0; c < D; ++c)
    tensor.template segment<2>(2 * c) = (reference.row(c) * inverse_jacobian).transpose();
  return tensor;
}

/// The curl (∂_y Ψ, −∂_x Ψ) of a function on the triangle with the given reference gradient.
inline Vector curl(const Eigen::Matrix2d& inverse_jacobian, const Eigen::RowVector2d& reference) {
  const Tensor<1> rise = gradient<1>(inverse_jacobian, reference);
  return {rise[1], -rise[0]};
}

}  // namespace signorini
