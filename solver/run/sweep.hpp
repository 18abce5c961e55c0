#pragma once

#include "condensed_problem.hpp"

namespace signorini {

/// What stands in an entry, of a solution of the variation.
SweepEntry entry_of(Solution solution);

/// Solves variations of a problem by its operator.
///
/// New loads and boundary values cost a forward and a backward solve and the element-wise recovery. New gaps
/// alone cost the dense step: where g changes by a function s of the clearance space (always for P0, for P1
/// if it is linear on each contact edge), λ − s moves as λ did, so c becomes c + S s, and energy, forces and
/// reactions follow from those of the last entry that was recovered, because they are quadratic and affine in
/// λ − s.
class Sweep {
 public:
  /// Of the problem whose operator was kept. The settings must outlive the sweep.
  Sweep(const Problem& problem, std::shared_ptr<const Operator> kept, const Settings& settings);
  ~Sweep();

  /// Throws Cancelled, SolveError and InvalidProblem.
  SweepEntry solve(const Variation& variation, Progress& progress);

 private:
  class Reference;

  const Settings& settings_;
  Problem varied_;
  std::shared_ptr<const Operator> operator_;
  std::unique_ptr<Reference> reference_;
};

}  // namespace signorini
