#include "contact/complete.hpp"

namespace signorini {

Completed complete(const Discretization& discrete, CondensedContact& condensed,
                   const Eigen::VectorXd& clearance, const std::vector<int>& exactly_open,
                   Progress& progress) {
  const Eigen::VectorXd x = condensed.traces(clearance, progress);
  Completed all{x, recover(discrete, x, progress)};
  // A stiff volume (ν → 1/2) costs the factorisation digits that iterative refinement brings back.
  constexpr int most_steps = 3;
  for (int step = 0; step < most_steps && !all.fields.is_balanced(discrete.traces); ++step) {
    const Eigen::VectorXd dx = condensed.correction(all.fields.imbalance, exactly_open, progress);
    change(discrete, dx, all.fields, progress);
    all.coupling += dx;
  }
  return all;
}

std::vector<int> open_unknowns(const Eigen::VectorXd& clearance) {
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(clearance.size()); ++i)
    if (clearance[i] > 0) open.push_back(i);
  return open;
}

}  // namespace signorini
