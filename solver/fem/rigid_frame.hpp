#pragma once

#include "problem/field.hpp"

namespace signorini {

/// A motion without strain: u = translation + rotation · (−(y − y₀), x − x₀) / size for an elastic body, with
/// (x₀, y₀) and size fixed by its frame; for a membrane only the first component of the translation counts.
using RigidMotion = Eigen::Vector3d;

/// The displacements of rigid motions at points, as rows of linear functionals of the motion.
class RigidFrame {
 public:
  RigidFrame(int components, Point centre, double size)
      : components_(components), centre_(std::move(centre)), size_(size) {}

  int components() const { return components_; }
  const Point& centre() const { return centre_; }
  double size() const { return size_; }

  /// u_c at x.
  Eigen::RowVector3d component(int c, const Point& x) const {
    if (components_ == 1) return {1, 0, 0};
    const Vector arm = (x - centre_) / size_;
    return c == 0 ? Eigen::RowVector3d(1, 0, -arm.y()) : Eigen::RowVector3d(0, 1, arm.x());
  }

  /// u_n at x, with u_n = −u for the membrane.
  Eigen::RowVector3d along(const Vector& normal, const Point& x) const {
    if (components_ == 1) return {-1, 0, 0};
    return normal.x() * component(0, x) + normal.y() * component(1, x);
  }

 private:
  int components_;
  Point centre_;
  double size_;
};

}  // namespace signorini
