#include <algorithm>

#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

/// C0, DEL, and C1 in UTF-8.
bool has_control_characters(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool is_c1 = byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    if (byte < 0x20 || byte == 0x7f || is_c1) return true;
  }
  return false;
}

}  // namespace

std::string read_title(const Value& value) {
  return value.text(limits::title).value_or("");
}

std::optional<std::string> fault_of_tag(const std::string& text) {
  if (text.empty()) return "must have at least one character";
  if (characters(text) > limits::tag)
    return "must have at most " + std::to_string(limits::tag) + " characters; it has " +
           std::to_string(characters(text));
  if (has_control_characters(text)) return "must have no control characters, such as line breaks";
  return std::nullopt;
}

std::vector<std::string> read_tags(const Value& value) {
  std::vector<std::string> tags;
  for (const Value& element : value.list("an array of strings", limits::tags)) {
    const auto* const text = element.json().get_ptr<const std::string*>();
    if (text == nullptr) {
      element.unexpected("a string of at most " + std::to_string(limits::tag) + " characters");
    } else if (const auto fault = fault_of_tag(*text)) {
      element.fault(*fault);
    } else if (std::ranges::find(tags, *text) != tags.end()) {
      element.fault("is the tag " + in_quotes(*text) + " again; give it once");
    } else {
      tags.push_back(*text);
    }
  }
  return tags;
}

}  // namespace signorini::api
