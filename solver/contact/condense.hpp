#pragma once

#include "contact/contact_complement.hpp"
#include "contact/operator.hpp"

namespace signorini {

/// One right side of the hybrid system with everything but the contact unknowns eliminated by the operator's
/// factor, and the way back.
class CondensedContact {
 public:
  /// One forward solve. The operator must outlive it.
  CondensedContact(const Operator& made, const Eigen::VectorXd& right, Progress& progress);

  const ContactComplement& contact() const { return contact_; }

  /// All traces for the clearances: one backward solve.
  Eigen::VectorXd traces(const Eigen::VectorXd& clearance, Progress& progress) {
    return factor_.expand(right_, clearance, workspace_, progress);
  }

  /// What the unknowns lack for an imbalance b − K x that the contact unknowns named open share and the
  /// others do not: one step of iterative refinement.
  Eigen::VectorXd correction(const Eigen::VectorXd& imbalance, const std::vector<int>& open,
                             Progress& progress);

 private:
  const Factor& factor_;
  Factor::Workspace workspace_;
  Factor::Condensed right_;
  ContactComplement contact_;
};

}  // namespace signorini
