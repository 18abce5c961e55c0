#pragma once

#include <stdexcept>
#include <vector>

#include <Eigen/SparseCore>

#include "progress/progress.hpp"

namespace signorini {

/// A pivot is zero.
struct SingularPivot : std::runtime_error {
  SingularPivot();
};

/// L D Lᵀ of a sparse symmetric matrix that has one in every order: a definite or a quasi-definite one
/// (Vanderbei 1995). Row by row (Davis 2005, Algorithm 849), in the order of an approximate minimum degree.
/// Eigen's hears nobody before it is done.
class SparseLdlt {
 public:
  /// Of the matrix with this lower triangle. Throws SingularPivot and what Progress throws.
  SparseLdlt(const Eigen::SparseMatrix<double>& lower, Progress& progress);

  /// The solution for a right side. Throws what Progress throws.
  Eigen::VectorXd solve(const Eigen::VectorXd& b, Progress& progress) const;

 private:
  using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

  void count(const Eigen::SparseMatrix<double>& upper);
  void factor(const Eigen::SparseMatrix<double>& upper, Progress& progress);

  Permutation order_;
  std::vector<int> parent_;         ///< of each column in the elimination tree; -1 at a root
  std::vector<std::size_t> first_;  ///< entry of each column below its diagonal, and behind the last
  std::vector<int> rows_;
  std::vector<double> values_;
  Eigen::VectorXd diagonal_;
};

}  // namespace signorini
