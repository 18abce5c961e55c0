#pragma once

// GCC says so by macros, Clang by features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SIGNORINI_IS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SIGNORINI_IS_SANITIZED
#endif
#endif

namespace signorini {

/// A sanitizer takes some twenty times as long: tests of numbers that run for many seconds take fewer of them
/// then.
#ifdef SIGNORINI_IS_SANITIZED
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace signorini
