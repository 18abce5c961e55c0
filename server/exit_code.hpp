#pragma once

namespace signorini::server {

constexpr int exit_done = 0;
constexpr int exit_failed = 1;     ///< the solve, or the service
constexpr int exit_bad_input = 2;  ///< a problem or flags that cannot be taken

}  // namespace signorini::server
