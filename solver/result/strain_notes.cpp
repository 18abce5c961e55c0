#include "strain_notes.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include <Eigen/LU>

#include "fem/raviart_thomas.hpp"

namespace signorini {
namespace {

/// Where |∇u| is larger the theory is off by more than about a twentieth of the strain.
constexpr double kLargeGradient = 0.1;
/// A singular corner has large gradients however small the load is, but on less of the body.
constexpr double kNoticeableShare = 0.01;

/// ∇u on triangle t of the displacement that is linear between the points of the mesh.
Eigen::Matrix2d gradient_on(const Solution& solution, int t, const AffineMap& map) {
  const auto& [a, b, c] = solution.mesh->triangles[t];
  const auto& u = solution.displacement_at_points;
  Eigen::Matrix2d reference;
  reference << u.col(b) - u.col(a), u.col(c) - u.col(a);
  return reference * map.jacobian.inverse();
}

}  // namespace

std::vector<std::string> notes_on_strains(const Solution& solution) {
  if (solution.components == 1) return {};
  double area = 0, large = 0, inside_out = 0, largest = 0;
  for (int t = 0; t < static_cast<int>(solution.mesh->triangles.size()); ++t) {
    const AffineMap map(solution.mesh->corners(t));
    const Eigen::Matrix2d gradient = gradient_on(solution, t, map);
    const double own = map.determinant / 2;
    area += own;
    largest = std::max(largest, gradient.norm());
    if (gradient.norm() > kLargeGradient) large += own;
    if ((Eigen::Matrix2d::Identity() + gradient).determinant() <= 0) inside_out += own;
  }
  std::vector<std::string> notes;
  std::ostringstream text;
  text << std::setprecision(2);
  if (large > kNoticeableShare * area) {
    text << "the displacement changes by up to " << largest
         << " of the length over which it does, and by more than " << kLargeGradient << " on "
         << 100 * large / area
         << " % of the body: the theory of small displacements does not describe this; check the units of "
            "loads, gaps "
            "and moduli";
    notes.push_back(text.str());
  }
  if (inside_out > kNoticeableShare * area) {
    text.str("");
    text << "the displaced body overlaps itself, " << 100 * inside_out / area
         << " % of it are turned inside out: the foundation begins too far inside the body, or the load is "
            "too large";
    notes.push_back(text.str());
  }
  return notes;
}

}  // namespace signorini
