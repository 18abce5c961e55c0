#pragma once

#include "fem/discretization.hpp"

namespace signorini {

/// The load f on one triangle after the other, evaluated once for each.
template <int D>
class LoadValues {
 public:
  explicit LoadValues(const Discretization& problem) : problem_(problem) {}

  using AtPoints = Eigen::Matrix<double, D, TriangleRule::size>;
  using AtCorners = Eigen::Matrix<double, D, 3>;

  /// Column q: f at point q of the triangle rule. Valid until the next call.
  const AtPoints& at_points(int t);

  /// Column z: (f, φ_z) for the hat function φ_z of corner z.
  AtCorners moments(int t);

  /// Column z: Πf at corner z, the load that σ* is in equilibrium with: the projection onto P1.
  AtCorners projection(int t);

 private:
  const Discretization& problem_;
  int last_ = -1;
  AtPoints at_points_ = AtPoints::Zero();
};

}  // namespace signorini
