#pragma once

#include "result/solution.hpp"

namespace signorini {

/// Whether all numbers are in the range of double precision: none is infinite, but for the ends of intervals,
/// and none is no number.
bool is_in_range(const ErrorBound& bound);
bool is_in_range(const Certified& certified);
bool is_in_range(const SweepEntry& entry);
/// Of the fields of a solution, and of what is summed up of them, before there is a bound.
bool is_in_range(const Solution& solution);

}  // namespace signorini
