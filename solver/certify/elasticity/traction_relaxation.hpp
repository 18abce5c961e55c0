#pragma once

#include "certify/elasticity/edge_tractions.hpp"
#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Lowers ‖σ* − sym σ_h‖_C of an elastic body by relax_stars(), over all linear tractions on the edges inside
/// and on Γ_D that leave every triangle in balance: those of the Airy functions of Hsieh, Clough and Tocher.
/// What is on the rest of the boundary stays.
///
/// Without it, σ* takes back the asymmetry of σ_h within the triangles at each point, one point after the
/// other.
void relax_tractions(const Discretization& discrete, const Eigen::MatrixXd& stress, EdgeTractions& tractions,
                     int sweeps, Progress& progress);

}  // namespace signorini
