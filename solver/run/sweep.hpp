#pragma once

#include <functional>

#include "kept_duals.hpp"

namespace signorini {

/// What stands in an entry, of a solution of the variation.
SweepEntry entry_of(Solution solution);

/// Shows the solution of a variation; empty if nobody looks.
using ShowSolution = std::function<void(const Solution&)>;

/// Solves variations of a problem by its operator, or where the material is another by the operator of that,
/// which is made on the same mesh: variations of one material that follow each other share one.
///
/// New loads and boundary values cost a forward and a backward solve, the element-wise recovery and the error
/// bound. New gaps alone cost the dense step, without fields that could be bounded: where g changes by a
/// function s of the clearance space (always for P0, for P1 if it is linear on each contact edge), λ − s
/// moves as λ did, so c becomes c + S s, and energy, forces and reactions follow from those of the last entry
/// that was recovered, because they are quadratic and affine in λ − s. Where solutions are shown, new gaps
/// cost as much as new loads.
class Sweep {
 public:
  /// Of the problem whose operator was kept. Problem and settings must outlive the sweep.
  Sweep(const Problem& problem, std::shared_ptr<const Operator> kept, const Settings& settings);
  Sweep(Sweep&&) noexcept;
  ~Sweep();

  /// Throws Cancelled, SolveError and InvalidProblem.
  SweepEntry solve(const Variation& variation, Progress& progress, const ShowSolution& show);

  /// The next variation owes nothing to those before it.
  void begin_anew();

  /// Which of the variations from `first` on would owe nothing to those before them anyway, if one is solved
  /// after the other. Throws Cancelled.
  std::vector<std::size_t> starts(const std::vector<Variation>& sweep, std::size_t first,
                                  Progress& progress) const;

 private:
  class Reference;

  bool is_at_hand(const Variation& variation) const;

  const Problem& problem_;
  const Settings& settings_;
  Problem varied_;
  const std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const Operator> operator_;  ///< null if none is at hand
  std::string material_key_;                  ///< of its material; empty: the problem's own
  std::unique_ptr<Reference> reference_;
  KeptDuals kept_{KeptDuals::For::sweep};
};

}  // namespace signorini
