#pragma once

#include <Eigen/Core>

#include "progress/observer.hpp"
#include "system/symmetric_product.hpp"

namespace signorini {

/// S is singular but for rounding.
struct SingularContact : SolveError {
  SingularContact()
      : SolveError(
            "nothing but contact holds the body, and only just, so that rounding decides where it is: "
            "hold it (fixed, roller), or bring its moduli, gaps and loads closer together") {}
};

/// The contact problem alone, everything else eliminated: find λ ≥ 0 with w p = S λ − c ≥ 0, λ p = 0, for
/// the clearances λ and pressures p of the contact unknowns. It is the minimum of ½ λᵀ S λ − cᵀ λ over
/// λ ≥ 0. S is symmetric positive definite, or semidefinite if contact alone holds the body; whoever made it
/// keeps it, for it is large.
struct ContactComplement {
  const Eigen::MatrixXd& s;  ///< stiffness of the contact boundary, force (per unit depth) / length
  Eigen::VectorXd c;         ///< forces that would open it
  Eigen::VectorXd weight;    ///< w, lengths

  Eigen::Index size() const { return c.size(); }
  /// w p. Throws what Progress throws.
  Eigen::VectorXd force(const Eigen::VectorXd& clearance, Progress& progress) const {
    return symmetric_product(s, clearance, progress) - c;
  }
};

}  // namespace signorini
