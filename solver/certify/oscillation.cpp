#include "certify/oscillation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "certify/linear_remainder.hpp"
#include "fem/lagrange.hpp"

namespace signorini {

template <int D>
double Oscillation<D>::operator()(int t, LawField<D>& law, const LoadValues<D>& load) const {
  const auto corners = problem_.mesh.corners(t);
  const double rest = load.projection(t).rest;
  double sum = rest > 0 ? linear_remainder<D>(corners) * rest : 0;
  for (int e = 0; e < 3; ++e)
    if (const int edge = problem_.mesh.triangle_edges[t][e]; traction_.acts_on(edge))
      sum += linear_remainder_on_edge<D>(corners, e) * of_traction(edge);
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

/// ‖t − Πt‖ on an edge.
template <int D>
double Oscillation<D>::of_traction(int edge) const {
  double square = 0;
  for (int c = 0; c < D; ++c) {
    const auto t = [&](double s) { return traction_(edge, c, s); };
    const LocalVector projection = project_onto_edge(2, edge_moments(2, t));
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q], rest = t(s) - projection.dot(edge_basis(2, s));
      square += edge_rule().weights[q] * rest * rest;
    }
  }
  return std::sqrt(square * problem_.mesh.length(edge));
}

template class Oscillation<1>;
template class Oscillation<2>;

}  // namespace signorini
