#include "fem/lagrange.hpp"

#include "fem/quadrature.hpp"

namespace signorini {

LocalVector edge_basis(int order, double s) {
  LocalVector values(order + 1);
  if (order == 0)
    values << 1;
  else
    values << 1 - s, s;
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

LocalVector edge_moments(int order, const std::function<double(double s)>& function) {
  LocalVector moments = LocalVector::Zero(order + 1);
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    moments += edge_rule().weights[q] * function(s) * edge_basis(order, s);
  }
  return moments;
}

LocalVector project_onto_edge(int order, const LocalVector& moments) {
  if (order == 0) return moments;
  // The mass matrix of 1 − s, s is [2 1; 1 2] / 6.
  LocalVector coefficients(2);
  coefficients << 4 * moments[0] - 2 * moments[1], 4 * moments[1] - 2 * moments[0];
  return coefficients;
}

}  // namespace signorini
