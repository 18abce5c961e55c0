#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Looks through all that is stored in a data directory and repairs what is damaged. What was found goes to
/// standard output. Returns exit_done if nothing is damaged, exit_failed if something was, and exit_bad_input
/// if the directory cannot be used, or a service runs on it.
int run_check(const CheckConfig& config);

}  // namespace signorini::server
