#include "contact/operator.hpp"

#include <numeric>

#include "progress/memory_meter.hpp"
#include "system/dense_cholesky.hpp"
#include "system/factorize.hpp"

namespace signorini {
namespace {

Eigen::VectorXd weights_of(const ClearanceSpace& space) {
  Eigen::VectorXd weight(space.unknowns);
  for (const ClearanceRow& row : space.rows)
    if (row.unknown >= 0) weight[row.unknown] = row.weight;
  return weight;
}

/// By more than rounding, as factorize() demands it of the other unknowns.
void require_positive_definite(const Eigen::MatrixXd& s, Progress& progress) {
  std::vector<int> all(s.rows());
  std::iota(all.begin(), all.end(), 0);
  const DenseCholesky factor(s, all, progress);
  constexpr double rounding = 1e-13;
  if (!factor.is_positive_definite() || !(factor.smallest_pivot() >= rounding * factor.largest_pivot()))
    throw NotPositiveDefinite();
}

}  // namespace

Operator::Operator(std::shared_ptr<const Mesh> mesh, const ClearanceSpace& space, const ElementSum& matrix,
                   bool held_by_contact_alone, Factorization by, Progress& progress)
    : mesh_(std::move(mesh)),
      factor_(factorize(matrix, space.unknowns, by, progress)),
      weight_(weights_of(space)) {
  if (!held_by_contact_alone) require_positive_definite(complement(), progress);
}

std::size_t Operator::bytes() const {
  return sizeof(Operator) + factor_.bytes() + static_cast<std::size_t>(weight_.size()) * sizeof(double) +
         mesh_->bytes();
}

std::shared_ptr<const Operator> on_loan(std::shared_ptr<const Operator> kept, MadeBy made_by) {
  const Operator* const lent = kept.get();
  return {lent, [kept = std::move(kept), made_by](const Operator*) mutable {
            const std::size_t bytes = kept->bytes();
            {
              const Unmetered others;
              kept.reset();
            }
            if (made_by == MadeBy::this_solve) hand_over(bytes);
          }};
}

}  // namespace signorini
