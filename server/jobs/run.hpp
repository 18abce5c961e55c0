#pragma once

#include <functional>
#include <string>

#include "api/problem/problem_json.hpp"
#include "contact/operator.hpp"
#include "server/idle_cores.hpp"
#include "server/jobs/job.hpp"
#include "server/jobs/live_solve.hpp"
#include "server/jobs/store.hpp"
#include "solve.hpp"

namespace signorini::server {

/// Solves a problem; the real one is solve() of the solver, tests take another.
using SolveFunction = std::function<Solution(const api::Request&, Observer&)>;

/// solve() of the solver, and the study if there is one, with the help of cores that are idle.
Solution solve_request(const api::Request& request, Observer& observer, OperatorCache& operators,
                       IdleCores& cores);

/// What a solution means for the job: a method that did not converge has failed, but its last iterate is
/// a result.
Ending ending_of(Solution solution);

/// Runs a job from its text to its end, within so many bytes of memory and by this factorisation, and with
/// helpers if there are any. Never throws: whatever goes wrong is an ending too.
Ending run(const Claim& claim, const SolveFunction& solve, LiveSolve& live, double max_memory,
           Factorization by, Helpers* helpers = nullptr);

}  // namespace signorini::server
