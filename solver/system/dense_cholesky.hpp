#pragma once

#include <vector>

#include <Eigen/Core>

#include "progress/progress.hpp"

namespace signorini {

/// The Cholesky factor of some rows and columns of a dense symmetric matrix, by blocks, so that a solve can
/// be ended while it is made.
class DenseCholesky {
 public:
  /// Throws OutOfMemory, and what Progress throws.
  DenseCholesky(const Eigen::MatrixXd& matrix, const std::vector<int>& chosen, Progress& progress);

  /// Every pivot was positive; else nothing else may be asked.
  bool is_positive_definite() const { return positive_; }
  double smallest_pivot()
      const;  ///< the square of the factor's smallest diagonal entry; infinite if it is empty
  double largest_pivot() const;  ///< likewise; 0 if it is empty

  /// The unknowns for one right side, both in the order of the chosen ones. Throws what Progress throws.
  Eigen::VectorXd solve(Eigen::VectorXd b, Progress& progress) const;

 private:
  Eigen::MatrixXd factor_;  ///< lower triangle
  bool positive_ = true;
};

}  // namespace signorini
