#pragma once

#include <cstdlib>

namespace signorini {

/// Whether tests are to take their full length: `tests/run --long`.
inline bool long_tests() {
  return std::getenv("SIGNORINI_LONG_TESTS") != nullptr;
}

}  // namespace signorini
