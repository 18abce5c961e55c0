#include "contact/condense.hpp"

#include "system/dense_cholesky.hpp"

namespace signorini {

CondensedContact::CondensedContact(const Operator& made, const Eigen::VectorXd& right, Progress& progress)
    : factor_(made.factor()),
      right_(factor_.condense(right, workspace_, progress)),
      contact_{made.complement(), right_.trailing, made.weight()} {}

Eigen::VectorXd CondensedContact::correction(const Eigen::VectorXd& imbalance, const std::vector<int>& open,
                                             Progress& progress) {
  const Factor::Condensed condensed = factor_.condense(imbalance, workspace_, progress);
  Eigen::VectorXd clearance = Eigen::VectorXd::Zero(contact_.size());
  const Eigen::VectorXd change =
      DenseCholesky(contact_.s, open, progress).solve(condensed.trailing(open), progress);
  for (std::size_t k = 0; k < open.size(); ++k) clearance[open[k]] = change[static_cast<Eigen::Index>(k)];
  return factor_.expand(condensed, clearance, workspace_, progress);
}

}  // namespace signorini
