#pragma once

#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// Factors by the multifrontal method (Duff, Reid 1983) in the order of a nested dissection: every piece
/// gathers its elements, or what its halves left, in a dense front, eliminates its pivots and leaves the rest
/// to the piece around it. What the whole leaves is the complement.
///
/// Throws NotPositiveDefinite if K_II is not, OutOfMemory, and what Progress throws.
Factor multifrontal(const ElementSum& matrix, int trailing, Progress& progress);

}  // namespace signorini
