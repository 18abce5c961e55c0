#pragma once

#include <chrono>

namespace signorini::server {

/// Since the machine was started: by a clock that nobody sets, and that goes on while the machine sleeps.
std::chrono::milliseconds boot_time();

}  // namespace signorini::server
