#pragma once

#include "problem/problem.hpp"
#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The last iterate of the paper's iteration, without an error bound.
Solution iterate_paper_form(const Problem& problem, const Settings& settings, Progress& progress);

/// The same with an error bound. The iterate of a criterion on increments is not in equilibrium, and a
/// theorem about it would be one about the criterion. So the discrete problem is solved besides, by
/// elimination; its bound and its distance from the iterate in the energy norm together bound the error of
/// the iterate, wherever it was ended.
Solution solve_paper_form(const Problem& problem, const Settings& settings, Progress& progress);

}  // namespace signorini
