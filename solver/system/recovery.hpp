#pragma once

#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Stress and displacement for given coupling unknowns, and how far the triangles are from fitting together.
struct Recovered {
  Eigen::MatrixXd stress;        ///< a column a triangle
  Eigen::MatrixXd displacement;  ///< a column a triangle
  /// <t, μ> − Σ G σ for each unknown: b − K x, but without the rounding of large translations and stiff
  /// volumes; for a contact unknown −<p, φ>.
  Eigen::VectorXd imbalance;
  double largest_flux = 0;    ///< the scale of the imbalance for traces
  double largest_moment = 0;  ///< and for rotations

  /// The free unknowns are balanced to rounding.
  bool is_balanced(const TraceSpace& traces) const;
};

/// Eliminates triangle by triangle once more and goes back.
Recovered recover(const Discretization& discrete, const Eigen::VectorXd& x, Progress& progress);

/// Adds to stress and displacement what follows from a change dx of the coupling unknowns, and balances anew.
///
/// The mixed system is well posed uniformly in ν, the elimination of σ is not: recovered from x + dx, the
/// stress would carry the rounding of x times the bulk modulus.
void change(const Discretization& discrete, const Eigen::VectorXd& dx, Recovered& fields, Progress& progress);

}  // namespace signorini
