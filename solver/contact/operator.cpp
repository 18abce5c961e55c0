#include "contact/operator.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace signorini {
namespace {

Eigen::VectorXd weights_of(const ClearanceSpace& space) {
  Eigen::VectorXd weight(space.unknowns);
  for (const ClearanceRow& row : space.rows)
    if (row.unknown >= 0) weight[row.unknown] = row.weight;
  return weight;
}

/// By more than rounding, as Cholesky demands it of the other unknowns.
void require_positive_definite(const Eigen::MatrixXd& s) {
  if (s.size() == 0) return;
  const Eigen::LLT<Eigen::MatrixXd> factor(s);
  const auto pivots = factor.matrixLLT().diagonal();
  constexpr double rounding = 1e-13;
  if (factor.info() != Eigen::Success || !(std::pow(pivots.minCoeff() / pivots.maxCoeff(), 2) >= rounding))
    throw NotPositiveDefinite();
}

}  // namespace

Operator::Operator(std::shared_ptr<const Mesh> mesh, const ClearanceSpace& space, const ElementSum& matrix,
                   bool held_by_contact_alone, Progress& progress)
    : mesh_(std::move(mesh)), factor_(matrix, space.unknowns, progress), weight_(weights_of(space)) {
  if (!held_by_contact_alone) require_positive_definite(complement());
}

std::size_t Operator::bytes() const {
  return sizeof(Operator) + factor_.bytes() + static_cast<std::size_t>(weight_.size()) * sizeof(double) +
         mesh_->bytes();
}

}  // namespace signorini
