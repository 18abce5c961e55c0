#include "certify/load_values.hpp"

#include <Eigen/LU>

#include "fem/lagrange.hpp"

namespace signorini {
namespace {

constexpr int kPoints = FineTriangleRule::size;

/// For a row of values at the points of the fine rule, the matrices that give the values of its projections:
/// onto P1 at the corners, onto P2 at the nodes, and what either leaves at the points, times the roots of the
/// weights.
struct Projections {
  using Square = Eigen::Matrix<double, kPoints, kPoints>;
  template <int Functions>
  using Onto = Eigen::Matrix<double, kPoints, Functions>;

  Projections() {
    const FineTriangleRule& rule = fine_triangle_rule();
    Onto<3> hats;
    Onto<6> quadratics;
    Eigen::Matrix<double, kPoints, 1> weights;
    for (int q = 0; q < kPoints; ++q) {
      hats.row(q) = triangle_basis(1, rule.points[q]).transpose();
      quadratics.row(q) = quadratic_basis(rule.points[q]).transpose();
      weights[q] = rule.weights[q];
    }
    const auto onto = [&]<int Functions>(const Onto<Functions>& basis) -> Onto<Functions> {
      const Onto<Functions> moments = weights.asDiagonal() * basis;
      return moments * (basis.transpose() * moments).inverse();
    };
    linear = onto(hats);
    quadratic = onto(quadratics);
    const Eigen::Matrix<double, kPoints, 1> roots = weights.cwiseSqrt();
    rest_of_linear = (Square::Identity() - linear * hats.transpose()) * roots.asDiagonal();
    rest_of_quadratic = (Square::Identity() - quadratic * quadratics.transpose()) * roots.asDiagonal();
  }

  Onto<3> linear;
  Onto<6> quadratic;
  Square rest_of_linear, rest_of_quadratic;
};

const Projections& projections() {
  static const Projections all;
  return all;
}

/// Column q: f at point q of the fine rule.
template <int D>
Eigen::Matrix<double, D, kPoints> at_points(const VectorField& body, const AffineMap& map) {
  Eigen::Matrix<double, D, kPoints> f;
  for (int q = 0; q < kPoints; ++q) {
    const Point x = map(fine_triangle_rule().points[q]);
    for (int c = 0; c < D; ++c) f(c, q) = body(c, x);
  }
  return f;
}

}  // namespace

template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& problem, int t) {
  const double area = AffineMap(problem.mesh.corners(t)).determinant / 2;
  if (problem.spaces().order == 0) return (problem.load.col(t) / area).replicate(1, 3);
  const Eigen::Matrix<double, D, 3> moments = problem.load.col(t).reshaped(D, 3);
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  return 12 / area * (moments.colwise() - moments.rowwise().sum() / 4);
}

template Eigen::Matrix<double, 1, 3> discrete_load<1>(const Discretization&, int);
template Eigen::Matrix<double, 2, 3> discrete_load<2>(const Discretization&, int);

template <int D>
LoadValues<D>::LoadValues(const Discretization& problem, Progress& progress) : problem_(problem) {
  if (!problem.load_varies) return;
  varying_.reserve(problem.triangles());
  for (int t = 0; t < problem.triangles(); ++t) {
    progress.check_in(t);
    varying_.push_back(project(t));
  }
}

template <int D>
typename LoadValues<D>::Projection LoadValues<D>::project(int t) const {
  Projection projection{at_nodes<D>(discrete_load<D>(problem_, t)), 0};
  if (!problem_.load_varies) return projection;
  const AffineMap map(problem_.mesh.corners(t));
  const auto f = at_points<D>(problem_.problem.body, map);
  const Projections& onto = projections();
  const Quadratic<D> linear = at_nodes<D>(f.lazyProduct(onto.linear));
  if (problem_.spaces().order == 0) projection.balanced = linear;
  constexpr double rounding = 1e-14;
  if (f.lazyProduct(onto.rest_of_linear).norm() <= rounding * f.norm()) return projection;
  projection.balanced += f.lazyProduct(onto.quadratic) - linear;
  projection.rest = std::sqrt(map.determinant) * f.lazyProduct(onto.rest_of_quadratic).norm();
  return projection;
}

template class LoadValues<1>;
template class LoadValues<2>;

}  // namespace signorini
