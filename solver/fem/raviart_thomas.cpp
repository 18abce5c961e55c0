#include "fem/raviart_thomas.hpp"

#include <Eigen/LU>

#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"

namespace signorini {
namespace {

/// P_k² + (x, y) P_k of degree k, columnwise.
LocalVectors monomials(int order, const Point& p) {
  const double x = p.x(), y = p.y();
  LocalVectors values;
  if (order == 0) {
    values.resize(2, 3);
    values << 1, 0, x, 0, 1, y;
  } else {
    values.resize(2, 8);
    values << 1, 0, x, 0, y, 0, x * x, x * y, 0, 1, 0, x, 0, y, x * y, y * y;
  }
  return values;
}

LocalVector monomial_divergences(int order, const Point& p) {
  LocalVector values;
  if (order == 0) {
    values.resize(3);
    values << 0, 0, 2;
  } else {
    values.resize(8);
    values << 0, 0, 1, 0, 0, 1, 3 * p.x(), 3 * p.y();
  }
  return values;
}

/// (∂_y b, −∂_x b) for b = 27 x y (1 − x − y).
Vector bubble_curl(const Point& p) {
  const double x = p.x(), y = p.y();
  return 27 * Vector(x * (1 - x - 2 * y), -y * (1 - 2 * x - y));
}

}  // namespace

RaviartThomas::RaviartThomas(int order, bool with_bubble) : order_(order), with_bubble_(with_bubble) {
  const int monomial_fields = size() - (with_bubble ? 1 : 0);
  coefficients_ = functionals(monomial_fields, [&](const Point& p) { return monomials(order, p); }).inverse();
}

template <typename Fields>
LocalMatrix RaviartThomas::functionals(int fields, const Fields& values) const {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  LocalMatrix functionals = LocalMatrix::Zero(edge_functions() + 2 * order_, fields);
  for (int e = 0; e < 3; ++e) {
    const Point &a = corners[(e + 1) % 3], &b = corners[(e + 2) % 3];
    const Vector scaled_normal(b.y() - a.y(), a.x() - b.x());  // outward, as long as the edge
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const LocalVector phi = edge_basis(order_, s);
      const Eigen::RowVectorXd flux = scaled_normal.transpose() * values(a + s * (b - a));
      functionals.middleRows(e * functions_per_edge(), functions_per_edge()) +=
          edge_rule().weights[q] * phi * flux;
    }
  }
  if (order_ == 1)
    for (int q = 0; q < TriangleRule::size; ++q)
      functionals.bottomRows(2) += triangle_rule().weights[q] * values(triangle_rule().points[q]);
  return functionals;
}

LocalVector RaviartThomas::interpolate(const AffineMap& map,
                                       const std::function<Vector(const Point& x)>& field) const {
  const Eigen::Matrix2d back = map.determinant * map.jacobian.inverse();
  return functionals(1, [&](const Point& p) -> Vector { return back * field(map(p)); });
}

LocalVectors RaviartThomas::reference_values(const Point& reference) const {
  LocalVectors values(2, size());
  values.leftCols(coefficients_.cols()) = monomials(order_, reference) * coefficients_;
  if (with_bubble_) values.rightCols(1) = bubble_curl(reference);
  return values;
}

LocalVector RaviartThomas::reference_divergences(const Point& reference) const {
  LocalVector divergences = LocalVector::Zero(size());
  divergences.head(coefficients_.cols()) =
      coefficients_.transpose() * monomial_divergences(order_, reference);
  return divergences;
}

LocalVectors RaviartThomas::values(const AffineMap& map, const Point& reference) const {
  return map.jacobian * reference_values(reference) / map.determinant;
}

}  // namespace signorini
