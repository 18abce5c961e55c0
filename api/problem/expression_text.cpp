#include "api/problem/expression_text.hpp"

#include <algorithm>

#include "api/limits.hpp"

namespace signorini::api {
namespace {

constexpr int deepest = 64;
constexpr std::string_view blanks = " \t\r\n";
constexpr std::string_view operators = "+-*/^()<>=!&|?:,";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool starts_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool continues_name(char c) {
  return starts_name(c) || is_digit(c);
}
bool is_blank(char c) {
  return blanks.find(c) != std::string_view::npos;
}

bool is_allowed(char c) {
  return continues_name(c) || c == '.' || is_blank(c) || operators.find(c) != std::string_view::npos;
}

int depth(std::string_view text) {
  int level = 0, deepest_level = 0;
  for (const char c : text) {
    if (c == '(') deepest_level = std::max(deepest_level, ++level);
    if (c == ')') --level;
  }
  return deepest_level;
}

/// Whether a `=` stands alone, not in `==`, `<=`, `>=` or `!=`.
bool assigns(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool pair = i + 1 < text.size() && text[i + 1] == '=';
    const bool compares = pair && std::string_view("=<>!").find(text[i]) != std::string_view::npos;
    if (compares) {
      ++i;
    } else if (text[i] == '=') {
      return true;
    }
  }
  return false;
}

/// Behind a number such as 2e5 that starts here: its letters are no name.
std::size_t behind_number(std::string_view text, std::size_t i) {
  const auto skip_digits = [&] {
    while (i < text.size() && (is_digit(text[i]) || text[i] == '.')) ++i;
  };
  skip_digits();
  std::size_t exponent = i;
  if (exponent < text.size() && (text[exponent] == 'e' || text[exponent] == 'E')) ++exponent;
  if (exponent > i && exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
  if (exponent == i || exponent == text.size() || !is_digit(text[exponent])) return i;
  i = exponent;
  skip_digits();
  return i;
}

std::size_t behind_name(std::string_view text, std::size_t i) {
  while (i < text.size() && continues_name(text[i])) ++i;
  return i;
}

}  // namespace

std::string text_fault(std::string_view text) {
  if (text.find_first_not_of(blanks) == std::string_view::npos) return "the expression is empty";
  if (text.size() > limits::expression)
    return "the expression has " + std::to_string(text.size()) + " characters; the most is " +
           std::to_string(limits::expression);
  if (const auto odd = std::ranges::find_if_not(text, is_allowed); odd != text.end())
    return "character " + std::to_string(1 + (odd - text.begin())) +
           " may not stand in an expression; allowed are letters a-z and A-Z, digits, . _ blanks and " +
           std::string(operators);
  if (depth(text) > deepest)
    return "parentheses are nested deeper than " + std::to_string(deepest) + " levels";
  if (assigns(text)) return "an expression assigns nothing; compare with ==";
  return {};
}

std::vector<std::string_view> names_in(std::string_view text) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < text.size();) {
    if (is_digit(text[i]) || text[i] == '.') {
      i = behind_number(text, i);
    } else if (starts_name(text[i])) {
      const std::size_t end = behind_name(text, i);
      names.push_back(text.substr(i, end - i));
      i = end;
    } else {
      ++i;
    }
  }
  return names;
}

}  // namespace signorini::api
