#include "certify/local_fields.hpp"

#include <Eigen/LU>

namespace signorini {

std::vector<Point> triangle_points() {
  return {triangle_rule().points.begin(), triangle_rule().points.end()};
}

CornerWeights corner_weights() {
  Eigen::Matrix3d mass = Eigen::Matrix3d::Zero();
  CornerWeights moments;
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Eigen::Vector3d hats = triangle_basis(1, triangle_rule().points[q]);
    moments.col(q) = triangle_rule().weights[q] * hats;
    mass += moments.col(q) * hats.transpose();
  }
  return mass.inverse() * moments;
}

Eigen::Matrix<double, 2, 6> quadratic_gradients(const Point& reference) {
  const double l1 = reference.x(), l2 = reference.y(), l0 = 1 - l1 - l2;
  const Vector g0(-1, -1), g1(1, 0), g2(0, 1);
  Eigen::Matrix<double, 2, 6> gradients;
  gradients << (4 * l0 - 1) * g0, (4 * l1 - 1) * g1, (4 * l2 - 1) * g2, 4 * (l1 * g2 + l2 * g1),
      4 * (l2 * g0 + l0 * g2), 4 * (l0 * g1 + l1 * g0);
  return gradients;
}

const std::array<Eigen::Matrix<double, 2, 6>, TriangleRule::size>& quadratic_gradients() {
  static const auto all = [] {
    std::array<Eigen::Matrix<double, 2, 6>, TriangleRule::size> gradients;
    for (int q = 0; q < TriangleRule::size; ++q)
      gradients[q] = quadratic_gradients(triangle_rule().points[q]);
    return gradients;
  }();
  return all;
}

}  // namespace signorini
