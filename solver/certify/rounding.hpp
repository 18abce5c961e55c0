#pragma once

namespace signorini {

/// What rounding leaves of sums of some million terms at most, relative to that of their sizes.
inline constexpr double kRoundingOfSums = 1e-13;

/// What rounding leaves of a field on a triangle, relative to the numbers that it is made of: a few of them
/// at a time are added up.
inline constexpr double kRoundingOfFields = 1e-15;

}  // namespace signorini
