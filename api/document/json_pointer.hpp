#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace signorini::api {

/// The JSON pointer (RFC 6901) of a member of the object at `parent`, `~` and `/` escaped.
std::string pointer_to(std::string_view parent, std::string_view member);

/// The JSON pointer of an element of the array at `parent`.
std::string pointer_to(std::string_view parent, std::size_t index);

}  // namespace signorini::api
