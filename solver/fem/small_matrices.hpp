#pragma once

#include <optional>

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

/// The shortest of these columns. Pivots of A that are smaller than so many times the largest count as 0;
/// rounding's by default.
Eigen::MatrixXd shortest_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                       std::optional<double> smallest_pivot = {});

/// An orthonormal basis of the x with A x = 0, by columns; pivots as above.
Eigen::MatrixXd kernel(const Eigen::MatrixXd& a, std::optional<double> smallest_pivot = {});

/// The upper triangular R with Rᵀ R = Aᵀ A, of an A with more rows than columns.
Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& a);

}  // namespace signorini
