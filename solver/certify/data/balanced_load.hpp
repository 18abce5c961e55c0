#pragma once

#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// Πf, the load that σ* is in equilibrium with.
template <int D>
Quadratic<D> balanced_load(const Discretization& discrete, int t) {
  return discrete.body[t].balanced;
}

/// Column z: at corner z the projection of Πf onto P0 or P1 that σ_h balances.
template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& discrete, int t) {
  const double area = AffineMap(discrete.mesh.corners(t)).determinant / 2;
  if (discrete.spaces().order == 0) return (discrete.load.col(t) / area).replicate(1, 3);
  const Eigen::Matrix<double, D, 3> moments = discrete.load.col(t).reshaped(D, 3);
  // The inverse of the mass matrix area/12 (1 + δ_ij) is 12/area (δ_ij − 1/4).
  return 12 / area * (moments.colwise() - moments.rowwise().sum() / 4);
}

}  // namespace signorini
