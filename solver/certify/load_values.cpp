#include "certify/load_values.hpp"

#include "fem/lagrange.hpp"

namespace signorini {

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

template <int D>
typename LoadValues<D>::AtCorners LoadValues<D>::moments(int t) {
  if (problem_.spaces().order == 1) return problem_.load.col(t).reshaped(D, 3);
  static const Eigen::Matrix<double, TriangleRule::size, 3> weighted_hats = [] {
    Eigen::Matrix<double, TriangleRule::size, 3> hats;
    for (int q = 0; q < TriangleRule::size; ++q)
      hats.row(q) = triangle_rule().weights[q] * triangle_basis(1, triangle_rule().points[q]).transpose();
    return hats;
  }();
  return AffineMap(problem_.mesh.corners(t)).determinant * at_points(t) * weighted_hats;
}

template <int D>
typename LoadValues<D>::AtCorners LoadValues<D>::projection(int t) {
  const double area = AffineMap(problem_.mesh.corners(t)).determinant / 2;
  const AtCorners own = moments(t);
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  return 12 / area * (own.colwise() - own.rowwise().sum() / 4);
}

template class LoadValues<1>;
template class LoadValues<2>;

}  // namespace signorini
