#include "fem/stress_invariants.hpp"

#include <cmath>
#include <numbers>

namespace signorini {

// Roots by hypot: a square of a stress in small or large units may leave the range of double precision.

std::array<double, 2> principal_stresses(const Eigen::Vector3d& stress) {
  const double mean = 0.5 * stress[0] + 0.5 * stress[1];
  const double radius = std::hypot(0.5 * stress[0] - 0.5 * stress[1], stress[2]);
  return {mean + radius, mean - radius};
}

double von_mises(const Eigen::Vector3d& stress, double out_of_plane) {
  const double normal = std::hypot(stress[0] - stress[1], stress[1] - out_of_plane, out_of_plane - stress[0]);
  return std::hypot(normal / std::numbers::sqrt2, std::numbers::sqrt3 * stress[2]);
}

}  // namespace signorini
