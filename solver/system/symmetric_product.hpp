#pragma once

#include <Eigen/Core>

#include "progress/progress.hpp"

namespace signorini {

/// S x of a dense symmetric matrix. Between pieces it looks at the observer: throws what Progress throws.
Eigen::VectorXd symmetric_product(const Eigen::MatrixXd& s, const Eigen::VectorXd& x, Progress& progress);

}  // namespace signorini
