#pragma once

#include <optional>

#include "fem/triangle_pieces.hpp"

namespace signorini {

/// A function f on a triangle by its projections onto polynomials. Norms and integrals are those of the
/// reference triangle.
///
/// The integrals behind it are sums over some points of pieces of the triangle. Where f is smooth their
/// errors are known from Taylor's theorem: f is a polynomial of degree k − 1 but for R_k = max |d^k f(x_T + t
/// (x − x_T)) / dt^k| / k!, and a rule of degree m integrates f φ with φ of degree j but for 2 R_{m − j + 1}
/// times the area and max |φ|, for its weights are positive.
struct Projection {
  using Nodes = Eigen::Matrix<double, 1, 6>;

  /// Π₂f and Π₁f at the corners and at the middles of edge 0, 1, 2.
  Nodes quadratic = Nodes::Zero(), linear = Nodes::Zero();
  double rest = 0, beyond_linear = 0;  ///< ‖f − Π₂f‖ and ‖f − Π₁f‖ are at most this
  double between = 0;                  ///< ‖Π₂f − Π₁f‖
  /// (f − Π₂f, φ) is at most this times max |φ|, for linear and for quadratic φ.
  double uncertain_force = 0, uncertain_work = 0;
  bool jumps = false;  ///< or has a kink
  bool is_finite = true;
};

/// What integrals may be off by, a value of f: where f is smooth a few cells meet the fine one; where it is
/// not, so many as that would take are not worth it.
struct ProjectionTolerance {
  double fine, rough;
  double rounding = 0;  ///< of values, up to which it counts as none
};

/// As far as the budget lasts. What is no formula is taken for what it is in the points of a rule.
Projection project(const Field& field, const std::array<Point, 3>& corners,
                   const ProjectionTolerance& tolerance, CellBudget& budget);

/// The value that a field has all over a box; nothing if it may vary there, or rounds to more than
/// `rounding`.
std::optional<double> constant_on(const Field& field, const Eigen::AlignedBox2d& box, double rounding);

/// Π₁ of a polynomial of P2, and its norm.
Projection::Nodes linear_part(const Projection::Nodes& quadratic);
double norm(const Projection::Nodes& quadratic);

}  // namespace signorini
