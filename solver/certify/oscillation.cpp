#include "certify/oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "certify/rigid_remainder.hpp"
#include "fem/lagrange.hpp"

namespace signorini {
namespace {

template <int D>
using Components = Eigen::Matrix<double, D, 1>;

double longest_edge(const std::array<Point, 3>& corners) {
  return std::max(
      {(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(), (corners[0] - corners[2]).norm()});
}

/// Column z: (f, φ_z).
template <int D>
Eigen::Matrix<double, D, 3> moments_of_hats(const Discretization& problem, int t) {
  Eigen::Matrix<double, D, 3> moments = Eigen::Matrix<double, D, 3>::Zero();
  const VectorField& body = problem.problem.body;
  if (body.size() == 0) return moments;
  const AffineMap map(problem.mesh.corners(t));
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point& reference = triangle_rule().points[q];
    const LocalVector hats = triangle_basis(1, reference);
    for (int c = 0; c < D; ++c)
      moments.row(c) +=
          triangle_rule().weights[q] * map.determinant * body(c, map(reference)) * hats.transpose();
  }
  return moments;
}

/// ‖w − w̄‖ ≤ remainder ‖∇w‖ for a membrane, ‖w − r‖ ≤ remainder ‖ε(w)‖ for an elastic body.
template <int D>
double remainder(const std::array<Point, 3>& corners) {
  if constexpr (D == 2)
    return rigid_remainder(corners);
  else
    return longest_edge(corners) / std::numbers::pi;
}

template <int D>
double remainder_on_edge(const std::array<Point, 3>& corners, int e) {
  if constexpr (D == 2) return rigid_remainder_on_edge(corners, e);
  const double length = (corners[(e + 2) % 3] - corners[(e + 1) % 3]).norm(), pi = std::numbers::pi;
  return longest_edge(corners) * std::sqrt(length * 2 / AffineMap(corners).determinant * (1 / pi + 1) / pi);
}

}  // namespace

template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& problem, int t) {
  const double area = AffineMap(problem.mesh.corners(t)).determinant / 2;
  if (D == 1 && problem.spaces().order == 0) return (problem.load.col(t) / area).template replicate<1, 3>();
  const Eigen::Matrix<double, D, 3> moments =
      problem.spaces().order == 1 ? problem.load.col(t).reshaped(D, 3) : moments_of_hats<D>(problem, t);
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  return 12 / area * (moments.colwise() - moments.rowwise().sum() / 4);
}

template <int D>
double Oscillation<D>::operator()(int t, LawField<D>& law) const {
  const auto corners = problem_.mesh.corners(t);
  const double load = of_load(t);
  double sum = load > 0 ? remainder<D>(corners) * load : 0;
  for (int e = 0; e < 3; ++e)
    if (const int edge = problem_.mesh.triangle_edges[t][e]; traction_.acts_on(edge))
      sum += remainder_on_edge<D>(corners, e) * of_traction(edge);
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
  const int order = D == 2 ? 1 : problem_.spaces().order;
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const auto t = [&](double s) { return traction_(edge, c, s); };
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
