#include "certify/load_values.hpp"

#include <Eigen/LU>

#include "fem/lagrange.hpp"

namespace signorini {
namespace {

using Matrix = Eigen::MatrixXd;

/// For a row of values at the points of a rule, the matrices that give the values of its projections: onto P1
/// at the corners, onto P2 at the nodes, and what either leaves at the points, times the roots of the
/// weights.
struct Projections {
  template <typename Rule>
  explicit Projections(const Rule& rule) {
    const int points = Rule::size;
    Matrix hats(3, points), quadratics(6, points);
    Eigen::VectorXd weights(points);
    for (int q = 0; q < points; ++q) {
      hats.col(q) = triangle_basis(1, rule.points[q]);
      quadratics.col(q) = quadratic_basis(rule.points[q]);
      weights[q] = rule.weights[q];
    }
    const auto onto = [&](const Matrix& basis) -> Matrix {
      const Matrix moments = weights.asDiagonal() * basis.transpose();
      return moments * (basis * moments).inverse();
    };
    const Matrix identity = Matrix::Identity(points, points);
    linear = onto(hats);
    quadratic = onto(quadratics);
    rest_of_linear = (identity - linear * hats) * weights.cwiseSqrt().asDiagonal();
    rest_of_quadratic = (identity - quadratic * quadratics) * weights.cwiseSqrt().asDiagonal();
  }

  Matrix linear, quadratic, rest_of_linear, rest_of_quadratic;
};

const Projections& projections() {
  static const Projections all(triangle_rule());
  return all;
}

const Projections& fine_projections() {
  static const Projections all(fine_triangle_rule());
  return all;
}

}  // namespace

template <int D>
const typename LoadValues<D>::AtPoints& LoadValues<D>::at_points(int t) {
  const VectorField& body = problem_.problem.body;
  if (body.size() == 0 || t == last_) return at_points_;
  last_ = t;
  const AffineMap map(problem_.mesh.corners(t));
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point x = map(triangle_rule().points[q]);
    for (int c = 0; c < D; ++c) at_points_(c, q) = body(c, x);
  }
  return at_points_;
}

/// That of the conforming scheme is the one that σ_h balances.
template <int D>
typename LoadValues<D>::AtCorners LoadValues<D>::linear(int t) {
  if (problem_.spaces().order == 0) return at_points(t) * projections().linear;
  const double area = AffineMap(problem_.mesh.corners(t)).determinant / 2;
  const AtCorners moments = problem_.load.col(t).reshaped(D, 3);
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  return 12 / area * (moments.colwise() - moments.rowwise().sum() / 4);
}

template <int D>
bool LoadValues<D>::is_linear(int t) {
  if (!problem_.load_varies) return true;
  const AtPoints& f = at_points(t);
  constexpr double rounding = 1e-14;
  return (f * projections().rest_of_linear).norm() <= rounding * f.norm();
}

template <int D>
const typename LoadValues<D>::Projection& LoadValues<D>::projection(int t) {
  if (t == last_projected_) return projection_;
  last_projected_ = t;
  projection_ = {at_nodes<D>(linear(t)), 0};
  if (is_linear(t)) return projection_;
  const AffineMap map(problem_.mesh.corners(t));
  Eigen::Matrix<double, D, FineTriangleRule::size> f;
  for (int q = 0; q < FineTriangleRule::size; ++q) {
    const Point x = map(fine_triangle_rule().points[q]);
    for (int c = 0; c < D; ++c) f(c, q) = problem_.problem.body(c, x);
  }
  const Projections& onto = fine_projections();
  projection_.balanced += f * onto.quadratic - at_nodes<D>(f * onto.linear);
  projection_.rest = std::sqrt(map.determinant) * (f * onto.rest_of_quadratic).norm();
  return projection_;
}

template class LoadValues<1>;
template class LoadValues<2>;

}  // namespace signorini
