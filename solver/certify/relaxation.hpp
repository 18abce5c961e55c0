#pragma once

#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"
#include "progress.hpp"

namespace signorini {

/// A quadratic displacement of a membrane by its values at all points and in the middles of all edges, with
/// those that may not change.
struct QuadraticValues {
  Eigen::VectorXd points, middles;
  std::vector<bool> held_points, held_middles;
};

/// The work on each of the quadratic functions, first of the points, then of the middles: of load and
/// traction, (Πf, φ) + <t, φ>, and of a stress, (τ, ∇φ).
Eigen::VectorXd work_of_loads(const Discretization& problem);
Eigen::VectorXd work_of_stress(const Discretization& problem, const StressField& tau);

/// The steps after which hardly anything is left of what an average has for error: that oscillates from
/// triangle to triangle. The bound of the nonconforming scheme falls by 40 %.
constexpr int kStepsFromAverage = 3;

/// Lowers ½ ‖∇v‖²_E − work(v) by so many steps of the method of conjugate gradients, scaled by the diagonal.
///
/// A modulus counts with its linear part on each triangle. With its value in the centroid only, v is not one
/// order better than u_h: the bound of the conforming scheme would double where the modulus varies.
void relax(const Discretization& problem, QuadraticValues& v, const Eigen::VectorXd& work, int steps,
           Progress& progress);

}  // namespace signorini
