#pragma once

#include <cstddef>
#include <string_view>

namespace signorini::server {

/// How much of a request has come.
enum class Arrival {
  part,       ///< the rest is worth waiting for
  whole,      ///< or as much as it takes to refuse it
  long_body,  ///< the head, and a body that is to be read as it comes
};

/// Looks at the first bytes of a connection, up to `longest_head` and `longest_body`. Only tells when it is
/// time to read the request: what it means, and whether it is sound, is found out by those who do.
Arrival arrival_of(std::string_view bytes, std::size_t longest_head, std::size_t longest_body);

}  // namespace signorini::server
