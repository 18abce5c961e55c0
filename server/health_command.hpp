#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Asks the service of this configuration whether it lives. Returns the exit code: 0 if it does.
int run_health(const DaemonConfig& config);

}  // namespace signorini::server
