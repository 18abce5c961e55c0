#pragma once

#include "fem/discretization.hpp"
#include "progress/progress.hpp"
#include "system/element_sum.hpp"

namespace signorini {

/// What is left of Problem 4.1 when stress and displacement are eliminated: the minimum of the strictly
/// convex ½ xᵀ K x − bᵀ x over the traces x with λ ≥ 0 for its contact unknowns.
struct HybridSystem {
  ElementSum matrix;      ///< K
  Eigen::VectorXd right;  ///< b
};

/// Eliminates triangle by triangle and adds up. Throws Cancelled.
HybridSystem assemble(const Discretization& discrete, Progress& progress);

/// The right side b alone, for a matrix that is factored already. Throws Cancelled.
Eigen::VectorXd assemble_right(const Discretization& discrete, Progress& progress);

/// Adds K c of one triangle to the forces on the unknowns, for coupling coefficients c in x and y components.
void add_forces(const Discretization& discrete, int triangle, const LocalVector& coupling,
                Eigen::VectorXd& forces);

}  // namespace signorini
