#pragma once

#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Solves the problem on meshes that refine themselves: solve, bound the error, bisect the triangles that
/// make up most of it; until the relative bound meets the tolerance of `problem.mesh.adaptive`. Each level
/// starts from the clearances of the one before it.
///
/// What ends it early after a first level (the cap on triangles, a bound that no longer falls, the time
/// limit, the observer, a level that cannot be solved) is no error: the solution is that of the level with
/// the smallest relative bound, and its outcome and advice say what happened. Throws what CondensedProblem
/// throws for the first level.
Solution adapt(const Problem& problem, const Settings& settings, Progress& progress);

}  // namespace signorini
