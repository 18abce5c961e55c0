#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Solves the problem of a file: the result to standard output, what went wrong as problem+json to
/// standard error. Returns the exit code.
int run_solve(const SolveConfig& config);

}  // namespace signorini::server
