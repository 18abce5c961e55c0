#pragma once

#include <vector>

#include <Eigen/Core>

namespace signorini {

/// What is left of the target without its projection on the cone, the sums of the generators with weights ≥
/// 0, in a few dimensions: 0 if the target is inside but for rounding; else it makes no acute angle with any
/// generator, and one with the target.
Eigen::VectorXd beyond_cone(const std::vector<Eigen::VectorXd>& generators, const Eigen::VectorXd& target);

}  // namespace signorini
