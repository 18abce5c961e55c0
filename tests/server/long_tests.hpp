#pragma once

#include <cstdlib>

namespace signorini::server {

/// Whether tests are to take their full length: `tests/run --long`.
inline bool long_tests() {
  return std::getenv("SIGNORINI_LONG_TESTS") != nullptr;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace signorini::server
