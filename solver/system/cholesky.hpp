#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>

#include "progress/progress.hpp"
#include "system/dissection.hpp"

namespace signorini {

/// The matrix is not positive definite, or not by more than rounding.
struct NotPositiveDefinite : std::runtime_error {
  NotPositiveDefinite();
};

/// The memory for the factor could not be had.
struct OutOfMemory : std::runtime_error {
  OutOfMemory();
};

/// The Cholesky factor of a sparse symmetric positive definite matrix K but for its trailing unknowns, by the
/// multifrontal method (Duff, Reid 1983) in the order of a nested dissection: every piece gathers its
/// elements, or what its halves left, in a dense front, eliminates its pivots and leaves the rest to the
/// piece around it.
///
/// With K = [K_II K_IC; K_CI K_CC], C the trailing unknowns, K_II = L Lᵀ is factored, and what the whole
/// leaves is the complement S = K_CC − K_CI K_II⁻¹ K_IC. A solve splits in two: condense, then expand.
///
/// Solving changes nothing in the factor: any number of threads may do so, each in a workspace of its own. It
/// throws what Progress throws.
class Cholesky {
 public:
  /// What a solve works in; kept from one solve to the next, it allocates nothing. For one thread at a time.
  struct Workspace {
    Eigen::VectorXd front;
  };

  /// Orders and factors. Throws NotPositiveDefinite if K_II is not, OutOfMemory, and what Progress throws.
  Cholesky(const ElementSum& matrix, int trailing, Progress& progress);

  /// S, in the order of the trailing unknowns.
  const Eigen::MatrixXd& complement() const { return complement_; }

  /// A right side after the forward solve.
  struct Condensed {
    Eigen::VectorXd forward;   ///< L⁻¹ b_I
    Eigen::VectorXd trailing;  ///< b_C − K_CI K_II⁻¹ b_I
  };
  Condensed condense(const Eigen::VectorXd& b, Workspace& workspace, Progress& progress) const;

  /// The unknowns (x_I, x_C) with x_C given and K_II x_I = b_I − K_IC x_C: one backward solve.
  Eigen::VectorXd expand(const Condensed& b, const Eigen::VectorXd& trailing, Workspace& workspace,
                         Progress& progress) const;

  /// x = K⁻¹ b in place, where no unknown is trailing.
  void solve(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;

  /// The memory that the factor takes.
  std::size_t bytes() const;

 private:
  class Factorisation;

  double* panel(int piece) const { return values_.get() + panel_begin_[piece]; }
  void forward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;
  void backward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;

  int trailing_;
  Dissection order_;
  std::vector<std::size_t> panel_begin_;  ///< in values_, of each piece's columns of L
  std::size_t count_ = 0;                 ///< of values_
  std::unique_ptr<double[]> values_;      ///< L, a dense panel of (front × pivots) a piece
  int largest_front_ = 0;
  Eigen::MatrixXd complement_;
};

}  // namespace signorini
