#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Serves until SIGINT or SIGTERM; returns the exit code.
int run_daemon(const DaemonConfig& config);

}  // namespace signorini::server
