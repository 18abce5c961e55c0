#pragma once

#include "certify/local_fields.hpp"
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

  /// Column z: the projection of f onto P1 at corner z.
  AtCorners linear(int t);

  /// Πf, the load that σ* is in equilibrium with, and ‖f − Πf‖: the projection onto P2.
  struct Projection {
    Quadratic<D> balanced = Quadratic<D>::Zero();
    double rest = 0;
  };
  /// Valid until the next call.
  const Projection& projection(int t);

 private:
  bool is_linear(int t);

  const Discretization& problem_;
  int last_ = -1, last_projected_ = -1;
  AtPoints at_points_ = AtPoints::Zero();
  Projection projection_;
};

}  // namespace signorini
