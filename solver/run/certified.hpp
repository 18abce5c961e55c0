#pragma once

#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Adds Summary::certified to a solution with a guaranteed bound, in the phase certify. Throws Cancelled.
void add_certified(const Problem& problem, const Settings& settings, Progress& progress, Solution& solution);

}  // namespace signorini
