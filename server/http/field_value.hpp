#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace signorini::server {

/// The parts of a header's value between such separators, without the blanks around them. One in a quoted
/// string (RFC 9110, 5.6.4) separates nothing.
std::vector<std::string_view> parts_of(std::string_view value, char separator);

/// The text in small letters.
std::string lower(std::string_view text);

/// The value of a preference in a Prefer header (RFC 7240, 2), without its quotes; empty if it has none. Of
/// one that stands several times the first counts. The name is given in small letters.
std::optional<std::string> preference(std::string_view prefer, std::string_view name);

}  // namespace signorini::server
