#pragma once

#include <functional>

#include "fem/raviart_thomas.hpp"

namespace signorini {

/// The basis of P_k on an edge at s ∈ [0, 1] from its first to its second end: 1 for k = 0; 1 − s, s for
/// k = 1; for k = 2 the functions that are 1 at the first end, the second, in the middle and 0 at the others.
LocalVector edge_basis(int order, double s);

/// The basis of P_k on the reference triangle: 1 for k = 0; for k = 1 the functions that are 1 at one
/// corner and 0 at the others.
LocalVector triangle_basis(int order, const Point& reference);

/// The gradients of the functions of P1 on a triangle, by columns.
Eigen::Matrix<double, 2, 3> hat_gradients(const AffineMap& map);

/// The six functions of P2 on the reference triangle: 1 at a corner, or in the middle of edge 0, 1, 2.
Eigen::Matrix<double, 6, 1> quadratic_basis(const Point& reference);

/// ∫ φ_i φ_j of them over the reference triangle.
const Eigen::Matrix<double, 6, 6>& quadratic_mass();

/// ∫ function φ_j ds over s ∈ [0, 1], for the functions of edge_basis.
LocalVector edge_moments(int order, const std::function<double(double s)>& function);

/// The coefficients in edge_basis of the function of P_k that has the given moments: the L2 projection of
/// whatever has them.
LocalVector project_onto_edge(int order, const LocalVector& moments);

/// The L2 projection of a function onto P_k, k = 0, 1, 2, at the first end, the second and in the middle.
Eigen::Vector3d projection_at_nodes(int order, const std::function<double(double s)>& function);

}  // namespace signorini
