#pragma once

#include <array>

#include "fem/edge_pieces.hpp"

namespace signorini {

/// A multiple b ≥ 0 of the bubble 4 s (1 − s) on an edge with v_n − 4 b s (1 − s) ≤ g, as small as the
/// enclosures of g let it be within some per cent; infinite where g is not known to be finite.
/// `normal_displacement` is the quadratic v_n at s = 0, ½, 1; `room` is g − v_n at the ends, of which what is
/// below zero counts as zero. The gap must be known on edges.
double bubble_below_gap(const Field& gap, const EdgeLine& line,
                        const std::array<double, 3>& normal_displacement, const std::array<double, 2>& room);

}  // namespace signorini
