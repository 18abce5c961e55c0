#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace signorini::api {

/// What no expression may be, seen without parsing it: empty, too long, too deep in parentheses, with
/// characters of another language, an assignment. Nothing if the text may be parsed.
std::string text_fault(std::string_view text);

/// The names (of variables, functions, constants) in an expression, as often as they stand there.
std::vector<std::string_view> names_in(std::string_view text);

}  // namespace signorini::api
