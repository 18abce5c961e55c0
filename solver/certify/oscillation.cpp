#include "certify/oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "fem/couple.hpp"
#include "fem/lagrange.hpp"

namespace signorini {
namespace {

template <int D>
using Components = Eigen::Matrix<double, D, 1>;

double longest_edge(const std::array<Point, 3>& corners) {
  return std::max(
      {(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(), (corners[0] - corners[2]).norm()});
}

/// ‖∇w‖ ≤ korn ‖ε(w)‖ for all w whose rotation has mean 0: √2 / β (Horgan, Payne 1983), with the inf-sup
/// constant β of the divergence at least sin(α / 4) for the smallest angle α (the bound of Horgan and Payne
/// from the centre of the inscribed circle; Costabel, Dauge 2015).
double korn(const std::array<Point, 3>& corners) {
  double largest_cosine = -1;
  for (int z = 0; z < 3; ++z) {
    const Vector a = corners[(z + 1) % 3] - corners[z], b = corners[(z + 2) % 3] - corners[z];
    largest_cosine = std::max(largest_cosine, a.normalized().dot(b.normalized()));
  }
  return std::numbers::sqrt2 / std::sin(std::acos(std::min(1., largest_cosine)) / 4);
}

}  // namespace

template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& problem, int t) {
  const Eigen::VectorXd moments = problem.load.col(t);
  const double area = AffineMap(problem.mesh.corners(t)).determinant / 2;
  if (problem.spaces().order == 0) {
    const Eigen::Matrix<double, D, 3> mean = (moments / area).replicate(1, 3);
    if constexpr (D == 2)
      return mean + load_with_couple(problem.couples[t], problem.mesh.corners(t));
    else
      return mean;
  }
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  const Eigen::Matrix<double, D, 3> own = moments.reshaped(D, 3);
  return 12 / area * (own.colwise() - own.rowwise().sum() / 4);
}

template <int D>
double Oscillation<D>::operator()(int t, LawField<D>& law) const {
  const auto corners = problem_.mesh.corners(t);
  const double h = longest_edge(corners) * (D == 2 ? korn(corners) : 1), pi = std::numbers::pi;
  double sum = h / pi * of_load(t);
  for (const int edge : problem_.mesh.triangle_edges[t])
    if (traction_.acts_on(edge))
      sum += h *
             std::sqrt(problem_.mesh.length(edge) * 2 / AffineMap(corners).determinant * (1 / pi + 1) / pi) *
             of_traction(edge);
  if (sum == 0) return 0;
  const int points = problem_.element.has_constant_material() ? 1 : TriangleRule::size;
  double softest = 0;
  for (int q = 0; q < points; ++q) {
    const Point x = AffineMap(corners)(triangle_rule().points[q]);
    const Eigen::SelfAdjointEigenSolver<TensorMap<D>> compliance(law(x).compliance, Eigen::EigenvaluesOnly);
    softest = std::max(softest, compliance.eigenvalues().maxCoeff());
  }
  return sum * std::sqrt(softest);
}

/// ‖f − Πf‖.
template <int D>
double Oscillation<D>::of_load(int t) const {
  if (problem_.problem.body.size() == 0) return 0;
  const AffineMap map(problem_.mesh.corners(t));
  std::array<Components<D>, TriangleRule::size> f;
  for (int q = 0; q < TriangleRule::size; ++q)
    for (int c = 0; c < D; ++c) f[q][c] = problem_.problem.body(c, map(triangle_rule().points[q]));
  if (std::ranges::all_of(f, [&](const Components<D>& value) { return value == f[0]; })) return 0;
  const Eigen::Matrix<double, D, 3> projection = discrete_load<D>(problem_, t);
  double square = 0;
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Eigen::Vector3d hats = triangle_basis(1, triangle_rule().points[q]);
    square += triangle_rule().weights[q] * map.determinant * (f[q] - projection * hats).squaredNorm();
  }
  return std::sqrt(square);
}

/// ‖t − Πt‖ on an edge.
template <int D>
double Oscillation<D>::of_traction(int edge) const {
  const int order = problem_.spaces().order;
  const auto& [a, b] = problem_.mesh.edges[edge];
  const Vector turning = problem_.spaces().leaves_couples()
                             ? traction_with_couple(couple_of_traction(traction_, problem_.mesh, edge),
                                                    problem_.mesh.points[b] - problem_.mesh.points[a])
                             : Vector(Vector::Zero());
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const auto t = [&](double s) { return traction_(edge, c, s) - (2 * s - 1) * turning[c]; };
    const LocalVector projection = project_onto_edge(order, edge_moments(order, t));
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q], rest = t(s) - projection.dot(edge_basis(order, s));
      square += edge_rule().weights[q] * rest * rest;
    }
  }
  return std::sqrt(square * problem_.mesh.length(edge));
}

template Eigen::Matrix<double, 2, 3> discrete_load<2>(const Discretization&, int);
template class Oscillation<1>;
template class Oscillation<2>;

}  // namespace signorini
