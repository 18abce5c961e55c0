#pragma once

#include "fem/discretization.hpp"
#include "progress.hpp"

namespace signorini {

/// A quadratic displacement of a membrane by its values at all points and in the middles of all edges, with
/// those that may not change.
struct QuadraticValues {
  Eigen::VectorXd points, middles;
  std::vector<bool> held_points, held_middles;
};

/// Lowers the energy J(v) by a few steps of the method of conjugate gradients, scaled by the diagonal. What
/// an average has for error oscillates from triangle to triangle, and of that hardly anything is left: the
/// bound of the nonconforming scheme falls by 40 %.
///
/// A modulus that varies counts as it is in the centroid.
void relax(const Discretization& problem, QuadraticValues& v, Progress& progress);

}  // namespace signorini
