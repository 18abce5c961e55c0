#include "server/http/field_value.hpp"

#include <algorithm>
#include <cctype>

namespace signorini::server {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

/// Where the first separator outside of quoted strings stands, else the length of the text.
std::size_t end_of_part(std::string_view text, char separator) {
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == separator && !quoted) return i;
    if (text[i] == '"') quoted = !quoted;
    if (text[i] == '\\' && quoted) ++i;
  }
  return text.size();
}

/// What a word means: a token itself, a quoted string without its quotes and backslashes.
std::string meaning_of(std::string_view word) {
  if (!word.starts_with('"')) return std::string(word);
  std::string meaning;
  for (std::size_t i = 1; i < word.size() && word[i] != '"'; ++i) {
    if (word[i] == '\\' && i + 1 < word.size()) ++i;
    meaning += word[i];
  }
  return meaning;
}

}  // namespace

std::vector<std::string_view> parts_of(std::string_view value, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = end_of_part(value, separator);
    parts.push_back(trimmed(value.substr(0, end)));
    if (end == value.size()) return parts;
    value.remove_prefix(end + 1);
  }
}

std::string lower(std::string_view text) {
  std::string letters(text);
  std::ranges::transform(letters, letters.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return letters;
}

std::optional<std::string> preference(std::string_view prefer, std::string_view name) {
  for (const std::string_view each : parts_of(prefer, ',')) {
    const std::string_view alone = parts_of(each, ';').front();  // what follows are its parameters
    const std::size_t sign = std::min(alone.find('='), alone.size());
    if (lower(trimmed(alone.substr(0, sign))) != name) continue;
    return meaning_of(trimmed(alone.substr(std::min(sign + 1, alone.size()))));
  }
  return std::nullopt;
}

}  // namespace signorini::server
