#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "server/http/request.hpp"

namespace signorini::server {

/// How long a client would wait for the end of its solve.
struct Wait {
  std::chrono::duration<double> time;
  std::optional<std::string> preferred;  ///< `wait=N` if it was asked by a Prefer header
  bool or_cancel = false;                ///< a client that leaves meanwhile does not want the solve any more
};

/// `?wait=SECONDS`, else `Prefer: wait=SECONDS` (RFC 7240, 4.3), and `?cancel=disconnect`. A bad query value
/// is refused; a preference that cannot be met is no error: it is ignored, or cut to an hour.
std::optional<Wait> wait_of(const Request& request);

}  // namespace signorini::server
