#pragma once

#include <array>

#include "fem/edge_pieces.hpp"

namespace signorini {

/// v_n ≤ g on an edge by what is taken off the quadratic v_n.
struct BelowGap {
  const Field& gap;  ///< known on edges
  const EdgeLine& line;
  std::array<double, 3> normal_displacement;  ///< v_n at s = 0, ½, 1
  std::array<double, 2> room;  ///< g − v_n at the ends, of which what is below zero counts as zero

  /// A multiple b ≥ 0 of the bubble 4 s (1 − s) with v_n − 4 b s (1 − s) ≤ g, as small as the enclosures of g
  /// let it be within some per cent; infinite where g is not known to be finite, or falls from v_n at an end
  /// without bound on its slope.
  double bubble(CellBudget& budget) const;

  /// What both ends must be lowered by first so that a small bubble is enough: 0 unless the bubble would be
  /// several times as high as v_n is above g, as where g falls steeply from v_n at an end and soon rises
  /// again.
  double level(CellBudget& budget) const;
};

}  // namespace signorini
