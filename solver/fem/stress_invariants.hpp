#pragma once

#include <array>

#include <Eigen/Core>

namespace signorini {

/// The principal stresses of (σ_xx, σ_yy, σ_xy) in the plane, σ₁ ≥ σ₂:
/// ½(σ_xx + σ_yy) ± √(¼(σ_xx − σ_yy)² + σ_xy²).
std::array<double, 2> principal_stresses(const Eigen::Vector3d& stress);

/// Von Mises' equivalent stress of (σ_xx, σ_yy, σ_xy) and the σ_zz out of the plane:
/// √(½((σ_xx − σ_yy)² + (σ_yy − σ_zz)² + (σ_zz − σ_xx)²) + 3σ_xy²).
double von_mises(const Eigen::Vector3d& stress, double out_of_plane);

}  // namespace signorini
