#pragma once

#include <string>

#include "problem/settings.hpp"
#include "solution.hpp"

namespace signorini {

/// What the residuals make of an end that the method took for convergence: `stalled` if they say that it is
/// no answer.
///
/// - `uzawa` with "auto" and `active_set` end by the contact residuals, so that those of the answer are below
///   twice the tolerance (`active_set` has that of `auto` by default), or 1e-9, where rounding may leave
///   them.
/// - The paper's criterion compares one displacement with the next, and is met by steps that are too short to
///   get anywhere. Its error is the change over one minus the rate, the residuals likewise: those beyond 100
///   times the tolerance, and beyond 1 %, are of an iteration that had a long way to go.
Outcome judged(Outcome outcome, const Residuals& residuals, const Settings& settings);

/// Why the method ended like this and what to try; empty if it converged.
std::string advice(const Settings& settings, Outcome outcome, int iterations);

}  // namespace signorini
