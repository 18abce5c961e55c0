#pragma once

#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"
#include "progress.hpp"

namespace signorini {

/// Column z: at corner z the projection of f onto P0 or P1 that σ_h balances.
template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& problem, int t);

/// The load f on all triangles, evaluated once.
template <int D>
class LoadValues {
 public:
  LoadValues(const Discretization& problem, Progress& progress);

  /// Πf, the load that σ* is in equilibrium with, and ‖f − Πf‖: the projection onto P2.
  struct Projection {
    Quadratic<D> balanced = Quadratic<D>::Zero();
    double rest = 0;
  };
  Projection projection(int t) const { return varying_.empty() ? project(t) : varying_[t]; }

 private:
  Projection project(int t) const;

  const Discretization& problem_;
  std::vector<Projection> varying_;  ///< empty if f is the same all over each triangle
};

}  // namespace signorini
