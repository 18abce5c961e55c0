#pragma once

#include "fem/discretization.hpp"
#include "result/solution.hpp"

namespace signorini {

/// A displacement at the points of the mesh, a column a point, one order better than u_h: on each triangle
/// the quadratic function whose mean is that of u_h and whose gradient is the linear part of C σ_h (and for
/// elasticity of the rotation), at each point the mean of what its triangles say, by their stiffness
/// (Stenberg 1991).
Eigen::MatrixXd displacement_at_corners(const Discretization& discrete, const Solution& solution,
                                        Progress& progress);

}  // namespace signorini
