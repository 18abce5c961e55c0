#include "certify/linear_balance.hpp"

#include "fem/lagrange.hpp"

namespace signorini {

/// The last two functionals of RT1 are the means of τ: with λ₁ = x̂ and λ₂ = ŷ, by parts,
///
///     ∫ τ̂_x = −∫ λ₁ div τ̂ + Σ ∫ λ₁ τ̂n.
std::optional<LinearBalance::Coefficients> LinearBalance::operator()(int t, LoadValues<1>& load) const {
  if (problem_.spaces().order == 1) return std::nullopt;
  const Mesh& mesh = problem_.mesh;
  Coefficients tau = Coefficients::Zero();
  Eigen::Vector3d at_corners = load.moments(t).transpose();
  const double scale = at_corners.norm();
  at_corners.array() -= at_corners.mean();
  constexpr double rounding = 1e-14;
  if (at_corners.norm() <= rounding * scale) at_corners.setZero();
  for (int e = 0; e < 3; ++e) {
    const int edge = mesh.triangle_edges[t][e];
    if (!traction_.acts_on(edge)) continue;
    const bool forward = mesh.triangles[t][(e + 1) % 3] == mesh.edges[edge][0];
    const LocalVector moments = mesh.length(edge) * edge_moments(1, [&](double s) {
                                  return traction_(edge, 0, forward ? s : 1 - s);
                                });
    for (int k = 0; k < 2; ++k) {
      tau[2 * e + k] = moments[k] - moments.mean();
      at_corners[(e + 1 + k) % 3] += tau[2 * e + k];
    }
  }
  tau.tail<2>() = at_corners.tail<2>();
  if (tau.isZero(0)) return std::nullopt;
  return tau;
}

}  // namespace signorini
