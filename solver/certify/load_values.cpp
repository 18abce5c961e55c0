#include "certify/load_values.hpp"

#include <type_traits>

#include <Eigen/LU>

#include "fem/lagrange.hpp"

namespace signorini {
namespace {

template <int D>
using Corners = Eigen::Matrix<double, D, 3>;

/// For a row of values at the points of a rule, the matrices that give the values of its projections: onto P1
/// at the corners, onto P2 at the nodes, and what either leaves at the points, times the roots of the
/// weights.
template <typename Rule>
struct Projections {
  static constexpr int kPoints = Rule::size;
  using Square = Eigen::Matrix<double, kPoints, kPoints>;
  template <int Functions>
  using Onto = Eigen::Matrix<double, kPoints, Functions>;

  explicit Projections(const Rule& rule) {
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

template <typename Rule>
const Projections<Rule>& projections() {
  static const Projections<Rule> all = [] {
    if constexpr (std::is_same_v<Rule, TriangleRule>)
      return Projections<Rule>(triangle_rule());
    else
      return Projections<Rule>(fine_triangle_rule());
  }();
  return all;
}

/// Column q: f at point q of the rule.
template <int D, typename Rule>
Eigen::Matrix<double, D, Rule::size> at_points(const VectorField& body, const AffineMap& map,
                                               const Rule& rule) {
  Eigen::Matrix<double, D, Rule::size> f;
  for (int q = 0; q < Rule::size; ++q) {
    const Point x = map(rule.points[q]);
    for (int c = 0; c < D; ++c) f(c, q) = body(c, x);
  }
  return f;
}

/// The linear part of f, as far as σ_h of the nonconforming scheme balances it as the scheme integrated it:
/// by its mean, for an elastic body its couple too.
template <int D>
Corners<D> linear_part(const Discretization& problem, int t, const AffineMap& map, const Corners<D>& linear) {
  if constexpr (D == 1) {
    return linear + discrete_load<D>(problem, t) - linear.rowwise().mean().replicate(1, 3);
  } else {
    const auto f = at_points<D>(problem.problem.body, map, triangle_rule());
    return f.lazyProduct(projections<TriangleRule>().linear);
  }
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
  const auto f = at_points<D>(problem_.problem.body, map, fine_triangle_rule());
  const auto& onto = projections<FineTriangleRule>();
  const Corners<D> linear = f.lazyProduct(onto.linear);
  if (problem_.spaces().order == 0)
    projection.balanced = at_nodes<D>(linear_part<D>(problem_, t, map, linear));
  constexpr double rounding = 1e-14;
  if (f.lazyProduct(onto.rest_of_linear).norm() <= rounding * f.norm()) return projection;
  projection.balanced += f.lazyProduct(onto.quadratic) - at_nodes<D>(linear);
  projection.rest = std::sqrt(map.determinant) * f.lazyProduct(onto.rest_of_quadratic).norm();
  return projection;
}

template class LoadValues<1>;
template class LoadValues<2>;

}  // namespace signorini
