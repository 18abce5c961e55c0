#include "fem/scheme.hpp"

#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

/// The same scalar form for each component.
LocalMatrix for_components(const LocalMatrix& form, int components) {
  LocalMatrix all = LocalMatrix::Zero(form.rows() * components, form.cols() * components);
  for (int i = 0; i < form.rows(); ++i)
    for (int j = 0; j < form.cols(); ++j)
      for (int c = 0; c < components; ++c) all(i * components + c, j * components + c) = form(i, j);
  return all;
}

Spaces pair(const RaviartThomas& row, int components) {
  const int order = row.order();
  const int functions = static_cast<int>(triangle_basis(order, Point(0, 0)).size());
  LocalMatrix divergence = LocalMatrix::Zero(functions, row.size()),
              mass = LocalMatrix::Zero(functions, functions);
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point& x = triangle_rule().points[q];
    const double weight = triangle_rule().weights[q];
    const LocalVector v = triangle_basis(order, x);
    divergence += weight * v * row.reference_divergences(x).transpose();
    mass += weight * v * v.transpose();
  }
  const LocalMatrix lifting = solve_definite(divergence * divergence.transpose(), divergence).transpose();
  const auto all = [components](const LocalMatrix& form) { return for_components(form, components); };
  return {order, components, row, all(divergence), all(mass), all(kernel(divergence)), all(lifting)};
}

}  // namespace

const Spaces& spaces_of(Scheme scheme, int components) {
  static const RaviartThomas rt0(0), rt1(1), peers(0, true);
  static const Spaces membrane_rt0 = pair(rt0, 1), membrane_rt1 = pair(rt1, 1);
  static const Spaces elastic_peers = pair(peers, 2), elastic_rt1 = pair(rt1, 2);
  if (scheme == Scheme::conforming) return components == 1 ? membrane_rt1 : elastic_rt1;
  return components == 1 ? membrane_rt0 : elastic_peers;
}

}  // namespace signorini
