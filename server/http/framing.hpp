#pragma once

#include <cstdint>

#include <httplib.h>

namespace signorini::server {

/// How the head of a request says that its body is delimited (RFC 9112, 6).
struct Framing {
  enum class Kind { none, sized, chunked, ambiguous };

  Kind kind = Kind::none;
  std::uint64_t length = 0;  ///< if sized
};

/// Reads Content-Length and Transfer-Encoding strictly. Where two readers could disagree (both headers,
/// two lengths, a length that is no number, a coding that is not `chunked`) the answer is `ambiguous`:
/// such a request is refused, for a proxy in front may have understood it otherwise.
Framing framing_of(const httplib::Headers& headers);

}  // namespace signorini::server
