#include "fem/lagrange.hpp"

#include <Eigen/LU>

#include "fem/cubature.hpp"

namespace signorini {

LocalVector edge_basis(int order, double s) {
  LocalVector values(order + 1);
  if (order == 0)
    values << 1;
  else if (order == 1)
    values << 1 - s, s;
  else
    values << (1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s);
  return values;
}

LocalVector triangle_basis(int order, const Point& reference) {
  LocalVector values(order == 0 ? 1 : 3);
  if (order == 0)
    values << 1;
  else
    values << 1 - reference.x() - reference.y(), reference.x(), reference.y();
  return values;
}

Eigen::Matrix<double, 2, 3> hat_gradients(const AffineMap& map) {
  Eigen::Matrix<double, 2, 3> reference;
  reference << -1, 1, 0, -1, 0, 1;
  return map.jacobian.inverse().transpose() * reference;
}

Eigen::Matrix<double, 6, 1> quadratic_basis(const Point& reference) {
  const double l1 = reference.x(), l2 = reference.y(), l0 = 1 - l1 - l2;
  Eigen::Matrix<double, 6, 1> values;
  values << l0 * (2 * l0 - 1), l1 * (2 * l1 - 1), l2 * (2 * l2 - 1), 4 * l1 * l2, 4 * l2 * l0, 4 * l0 * l1;
  return values;
}

const Eigen::Matrix<double, 6, 6>& quadratic_mass() {
  static const Eigen::Matrix<double, 6, 6> mass = [] {
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    for (const auto& [point, weight] : rule_of_degree(4))
      sum += weight * quadratic_basis(point) * quadratic_basis(point).transpose();
    return sum;
  }();
  return mass;
}

LocalVector edge_moments(int order, const std::function<double(double s)>& function) {
  LocalVector moments = LocalVector::Zero(order + 1);
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    moments += edge_rule().weights[q] * function(s) * edge_basis(order, s);
  }
  return moments;
}

LocalVector project_onto_edge(int order, const LocalVector& moments) {
  // Times the inverse of the mass matrix: of [2 1; 1 2] / 6 for k = 1, [4 -1 2; -1 4 2; 2 2 16] / 30 for k
  // = 2.
  LocalVector coefficients = moments;
  if (order == 1) coefficients << 4 * moments[0] - 2 * moments[1], 4 * moments[1] - 2 * moments[0];
  if (order == 2)
    coefficients << 9 * moments[0] + 3 * moments[1] - 1.5 * moments[2],
        3 * moments[0] + 9 * moments[1] - 1.5 * moments[2],
        -1.5 * moments[0] - 1.5 * moments[1] + 2.25 * moments[2];
  return coefficients;
}

Eigen::Vector3d projection_at_nodes(int order, const std::function<double(double s)>& function) {
  const LocalVector own = project_onto_edge(order, edge_moments(order, function));
  if (order == 2) return own;
  return {own[0], own[order], (own[0] + own[order]) / 2};
}

}  // namespace signorini
