#pragma once

#include <Eigen/Core>

namespace signorini {

// What is asked of small matrices in many places, for all sizes once: to compile Eigen's decompositions takes
// seconds for each type of matrix.

/// The eigenvalues of a symmetric matrix, from the least to the largest, and orthonormal vectors to them by
/// columns.
struct Spectrum {
  explicit Spectrum(const Eigen::MatrixXd& symmetric);

  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// The eigenvalues alone.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

/// A⁻¹ B for a symmetric positive definite A.
Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The columns X with the least ‖A X − B‖.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace signorini
