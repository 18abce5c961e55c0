#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace signorini::api {

/// The text between quotation marks, cut (at a character's end) where it is too long for a message.
std::string in_quotes(std::string_view text);

/// `a, b, c`.
std::string list_of(const std::vector<std::string_view>& names);

/// The number with the fewest digits that tell it from its neighbours.
std::string shortest(double number);

/// ` (did you mean "size"?)` if one of the names is a slip of the pen away from the word, else nothing.
std::string suggestion(std::string_view word, const std::vector<std::string_view>& names);

}  // namespace signorini::api
