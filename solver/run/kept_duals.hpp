#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>

#include "certify/shape_norms.hpp"
#include "run/dual_solution.hpp"
#include "run/memory_estimate.hpp"
#include "run/openings.hpp"

namespace signorini {

/// What the certificate and the quantities of a problem need that neither its loads nor its gaps change: the
/// entries of a sweep, which share an operator, share that, too.
class KeptDuals {
 public:
  /// Those of a sweep are kept as far as there is room, which memory_of_kept_duals() foresees.
  enum class For { one_solve, sweep };
  explicit KeptDuals(For use) : most_(use == For::sweep ? kRoomForDuals : 0) {}

  /// That of quantity i of the problem, until the next one is asked for.
  CondensedDual& dual(const CondensedProblem& base, std::size_t i, Progress& progress);
  const Pull& pull(const CondensedProblem& base, std::size_t i, Factorization by, Progress& progress);
  ShapeNorms& norms(const CondensedProblem& base);

  /// Lets go of all, and of the operator.
  void clear();

 private:
  void begin_anew_unless(const CondensedProblem& base);

  std::shared_ptr<const Operator> operator_;
  double most_, used_ = 0;
  std::map<std::size_t, std::unique_ptr<CondensedDual>> duals_;
  std::unique_ptr<CondensedDual> last_;  ///< for which there was no room
  std::map<std::size_t, Pull> pulls_;
  ShapeNorms norms_;
};

}  // namespace signorini
