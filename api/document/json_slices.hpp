#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Parts of a JSON text as texts, so that many documents in one need not be in memory at once. The text must
/// be JSON, as require_json() sees.
namespace signorini::api {

/// The members of the object; none if the text is none.
std::vector<std::pair<std::string, std::string_view>> member_slices(std::string_view object);

/// The elements of the array; none if the text is none.
std::vector<std::string_view> element_slices(std::string_view array);

}  // namespace signorini::api
