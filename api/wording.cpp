#include "api/wording.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>

namespace signorini::api {
namespace {

/// A message stays readable, and small, whatever the client sent.
constexpr std::size_t longest_quote = 60;
constexpr std::size_t most_listed = 50;

/// The number of insertions, deletions and replacements of single bytes that turn one into the other.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] != to[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[to.size()];
}

}  // namespace

std::string in_quotes(std::string_view text) {
  if (text.size() <= longest_quote) return '"' + std::string(text) + '"';
  std::size_t end = longest_quote;
  const auto continues_character = [&](std::size_t i) { return (text[i] & '\xC0') == '\x80'; };
  while (end > 0 && continues_character(end)) --end;
  return '"' + std::string(text.substr(0, end)) + "…\"";
}

std::string list_of(const std::vector<std::string_view>& names) {
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), most_listed); ++i) {
    if (!list.empty()) list += ", ";
    list += names[i];
  }
  return names.size() > most_listed ? list + ", … (" + std::to_string(names.size()) + " in all)" : list;
}

std::string shortest(double number) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& names) {
  if (word.size() > longest_quote || names.empty() || names.size() > most_listed) return {};
  const auto distance = [&](std::string_view name) { return edit_distance(word, name); };
  const std::string_view nearest = *std::ranges::min_element(names, {}, distance);
  const std::size_t slips = nearest.size() <= 4 ? 1 : 2;
  return distance(nearest) <= slips ? " (did you mean " + in_quotes(nearest) + "?)" : std::string();
}

}  // namespace signorini::api
