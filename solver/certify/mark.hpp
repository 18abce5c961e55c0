#pragma once

#include <vector>

#include <Eigen/Core>

namespace signorini {

/// The fewest triangles whose shares in the square of the error bound add up to the given part of it (Dörfler
/// 1996), the largest first. Half of it keeps the rate of the best possible meshes and takes few levels.
std::vector<int> mark(const Eigen::VectorXd& squares, double bulk = 0.5);

}  // namespace signorini
