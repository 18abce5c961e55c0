#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Solves the study of a problem in a file: its table to standard output, what went wrong as problem+json to
/// standard error. Returns the exit code.
int run_study_command(const StudyConfig& config);

}  // namespace signorini::server
