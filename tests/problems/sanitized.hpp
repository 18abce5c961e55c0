#pragma once

namespace signorini {

/// A sanitizer takes some twenty times as long: tests of numbers that run for many seconds take fewer of them
/// then.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace signorini
