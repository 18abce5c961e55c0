#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace signorini {

/// direction · v ≤ bound, or equality; the direction has length 1.
struct PointConstraint {
  Eigen::VectorXd direction;
  double bound;
  bool equality;
  bool is_roller = false;
  double rounding = 0;  ///< the angle by which it may have turned the direction
};

/// The point nearest to v that meets all constraints up to rounding of the given scale, or nothing if there
/// is none. At most two directions are independent.
std::optional<Eigen::VectorXd> nearest_admissible(const Eigen::VectorXd& v,
                                                  const std::vector<PointConstraint>& constraints,
                                                  double scale);

}  // namespace signorini
