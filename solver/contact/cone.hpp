#pragma once

#include <vector>

#include <Eigen/Core>

namespace signorini {

/// Whether the target is a sum of the generators with weights ≥ 0, in at most three dimensions.
bool is_inside_cone(const std::vector<Eigen::VectorXd>& generators, const Eigen::VectorXd& target);

}  // namespace signorini
