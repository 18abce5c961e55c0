#pragma once

#include "certify/patches/patch.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The contact problem of a membrane on a patch, solved exactly: that of the whole with a condition on the
/// cut besides, and with the foundation as near as there. Throws SolveError, NotPositiveDefinite and
/// Cancelled.
class LocalContact {
 public:
  LocalContact(const Discretization& whole, const Patch& patch, const Condition& on_cut, Progress& progress);

  const Discretization& discretization() const { return discretization_; }
  /// Only stress and displacement.
  const Solution& solution() const { return solution_; }
  const Eigen::VectorXd& coupling() const { return coupling_; }
  const Eigen::VectorXd& clearance() const { return clearance_; }  ///< a value a row of the clearance space
  bool is_balanced() const { return is_balanced_; }

 private:
  const Problem problem_;
  Discretization discretization_;
  Solution solution_;
  Eigen::VectorXd coupling_, clearance_;
  bool is_balanced_ = false;
};

}  // namespace signorini
