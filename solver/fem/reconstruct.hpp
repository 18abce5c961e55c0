#pragma once

#include "fem/scheme.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Column t: σ_h at the centroid of triangle t as (σ_x, σ_y), or (σ_xx, σ_yy, σ_xy) with the mean of σ_xy and
/// σ_yx.
Eigen::MatrixXd stress_at_centroids(const Mesh& mesh, const Spaces& spaces, const Eigen::MatrixXd& stress);

/// σ_zz at the centroids of an elastic body: ν (σ_xx + σ_yy) in plane strain, else 0. Empty for a membrane.
Eigen::VectorXd out_of_plane_stress(const Material& material, const Mesh& mesh,
                                    const Eigen::MatrixXd& stress_at_centroids);

/// A continuous displacement for pictures: on each triangle the linear function with the mean of u_h and
/// the gradient that stress and rotation give at its centroid (Stenberg 1991), averaged at each point, and
/// u_D on Γ_D. Needs the solution's mesh, displacement, stress at the centroids and rotation.
Eigen::MatrixXd displacement_at_points(const Problem& problem, const Solution& solution);

}  // namespace signorini
