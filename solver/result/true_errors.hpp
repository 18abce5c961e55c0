#pragma once

#include "problem/study.hpp"
#include "progress/progress.hpp"
#include "solution.hpp"

namespace signorini {

/// The errors of a solution of the problem, as far as the exact one is known. The integrals are by rules of
/// degree 5 on four parts of each triangle and on each edge of Γ_C. Throws InvalidProblem where the exact
/// solution is not finite, and Cancelled.
TrueErrors true_errors(const Problem& problem, const Exact& exact, const Solution& solution,
                       Observer& observer);

}  // namespace signorini
