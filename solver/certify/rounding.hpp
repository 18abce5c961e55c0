#pragma once

namespace signorini {

/// What rounding leaves of sums of some million terms at most, relative to that of their sizes.
inline constexpr double kRoundingOfSums = 1e-13;

}  // namespace signorini
