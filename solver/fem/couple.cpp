#include "fem/couple.hpp"

#include <cmath>

#include "fem/quadrature.hpp"

namespace signorini {

double couple_of_traction(const TractionField& traction, const Mesh& mesh, int edge) {
  const auto& [a, b] = mesh.edges[edge];
  const Vector way = mesh.points[b] - mesh.points[a];
  double couple = 0;
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    const Vector arm = turned_left((s - 0.5) * way);
    couple += edge_rule().weights[q] * (arm.x() * traction(edge, 0, s) + arm.y() * traction(edge, 1, s));
  }
  return couple * way.norm();
}

/// ∫ |x − x_T|² = |T| / 12 Σ |x_z − x_T|².
Eigen::Matrix<double, 2, 3> load_with_couple(double couple, const std::array<Point, 3>& corners) {
  const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
  Eigen::Matrix<double, 2, 3> arms;
  for (int z = 0; z < 3; ++z) arms.col(z) = turned_left(corners[z] - centroid);
  const Vector a = corners[1] - corners[0], b = corners[2] - corners[0];
  const double area = (a.x() * b.y() - a.y() * b.x()) / 2;
  return couple * 12 / (area * arms.squaredNorm()) * arms;
}

/// ∫ |x − x_e|² = |e|³ / 12.
Vector traction_with_couple(double couple, const Vector& edge) {
  return couple * 6 / std::pow(edge.norm(), 3) * turned_left(edge);
}

}  // namespace signorini
