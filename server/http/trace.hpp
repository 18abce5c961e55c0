#pragma once

#include <optional>
#include <string>

namespace signorini::server {

/// The trace of a distributed system that a request belongs to (W3C Trace Context), and the step in it that
/// this service takes.
struct Trace {
  std::string id;     ///< 32 hexadecimal digits
  std::string span;   ///< 16 hexadecimal digits, made here
  std::string flags;  ///< 2 hexadecimal digits, as sent
};

/// Reads a `traceparent` header; nothing if it is malformed, which the standard says to ignore.
std::optional<Trace> read_traceparent(const std::string& header);

/// The header that names this service's step.
std::string traceparent(const Trace& trace);

}  // namespace signorini::server
