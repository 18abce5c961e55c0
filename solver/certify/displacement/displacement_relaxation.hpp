#pragma once

#include <vector>

#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// How the value of an elastic displacement in a node may change: not at all, or not along a normal, or
/// freely.
struct NodeFreedom {
  bool held = false;
  Vector normal{0, 0};  ///< 0 where it is free
  double rounding = 0;  ///< the angle by which it may have turned the normal

  /// Takes the freedom along n away; two different normals hold the node.
  void hold_along(const Vector& n, double rounding_of_n);
};

/// Lowers ½ ‖ε(v)‖²_E − (Πf, v) − <Πt, v> of an elastic body's displacement: its values at the points and in
/// the middles of the edges, by relax_stars(); inside each macro-element it follows as it costs least.
///
/// `freedom`: of the points, then of the edges. `points`, `middles`: a column each.
void relax_displacement(const Discretization& discrete, const std::vector<NodeFreedom>& freedom, int sweeps,
                        Eigen::MatrixXd& points, Eigen::MatrixXd& middles, Progress& progress);

}  // namespace signorini
