#include "run/kept_duals.hpp"

namespace signorini {

void KeptDuals::clear() {
  duals_.clear();
  last_.reset();
  pulls_.clear();
  norms_ = {};
  operator_.reset();
  used_ = 0;
}

/// Another operator is that of another material.
void KeptDuals::begin_anew_unless(const CondensedProblem& base) {
  if (operator_ == base.used_operator()) return;
  clear();
  operator_ = base.used_operator();
}

ShapeNorms& KeptDuals::norms(const CondensedProblem& base) {
  begin_anew_unless(base);
  return norms_;
}

CondensedDual& KeptDuals::dual(const CondensedProblem& base, std::size_t i, Progress& progress) {
  begin_anew_unless(base);
  if (const auto found = duals_.find(i); found != duals_.end()) return *found->second;
  const Discretization& discrete = base.discretization();
  const Quantity& quantity = discrete.problem.quantities[i];
  last_.reset();
  auto made = std::make_unique<CondensedDual>(base, quantity, progress);
  const double bytes = memory_of_kept_dual(
      quantity, discrete.spaces(),
      {static_cast<double>(discrete.triangles()), static_cast<double>(discrete.traces.unknowns())});
  if (used_ + bytes > most_) return *(last_ = std::move(made));
  used_ += bytes;
  return *(duals_[i] = std::move(made));
}

const Pull& KeptDuals::pull(const CondensedProblem& base, std::size_t i, Factorization by,
                            Progress& progress) {
  begin_anew_unless(base);
  const Discretization& discrete = base.discretization();
  const auto found = pulls_.find(i);
  if (found != pulls_.end()) return found->second;
  return pulls_.emplace(i, pull_of(discrete.problem.quantities[i], discrete, by, progress)).first->second;
}

}  // namespace signorini
