#include "certify/displacement/point_constraints.hpp"

#include <cmath>

#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

using Constraints = std::vector<PointConstraint>;

/// The nearest point at which the chosen constraints hold with equality.
Eigen::VectorXd project(const Eigen::VectorXd& v, const Constraints& chosen) {
  Eigen::MatrixXd directions(chosen.size(), v.size());
  Eigen::VectorXd excess(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    directions.row(static_cast<Eigen::Index>(i)) = chosen[i].direction.transpose();
    excess[static_cast<Eigen::Index>(i)] = chosen[i].direction.dot(v) - chosen[i].bound;
  }
  return v - shortest_least_squares(directions, excess);
}

bool meets(const Eigen::VectorXd& v, const Constraints& constraints, double rounding) {
  for (const PointConstraint& constraint : constraints) {
    const double excess = constraint.direction.dot(v) - constraint.bound;
    if (excess > rounding || (constraint.equality && excess < -rounding)) return false;
  }
  return true;
}

}  // namespace

std::optional<Eigen::VectorXd> nearest_admissible(const Eigen::VectorXd& v, const Constraints& constraints,
                                                  double scale) {
  const double rounding = 1e-12 * scale;
  if (meets(v, constraints, 0)) return v;
  // The nearest point lies on one constraint or on two: try every choice.
  std::optional<Eigen::VectorXd> nearest;
  for (std::size_t i = 0; i < constraints.size(); ++i)
    for (std::size_t j = i; j < constraints.size(); ++j) {
      const Constraints chosen =
          i == j ? Constraints{constraints[i]} : Constraints{constraints[i], constraints[j]};
      const Eigen::VectorXd candidate = project(v, chosen);
      if (!meets(candidate, constraints, rounding)) continue;
      if (!nearest || (candidate - v).norm() < (*nearest - v).norm()) nearest = candidate;
    }
  return nearest;
}

}  // namespace signorini
