#include "api/problem/gmsh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "api/wording.hpp"
#include "problem/field.hpp"

namespace signorini::api {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/// Whether the whole word is a number of the type.
template <typename T>
bool read(std::string_view word, T& value) {
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

void GmshText::fail_at(int line, std::string detail) {
  throw InvalidProblem({{"/domain/msh", "line " + std::to_string(line) + ": " + std::move(detail)}});
}

void GmshText::skip_space() {
  std::size_t i = 0;
  for (; i < rest_.size() && is_space(rest_[i]); ++i) line_ += rest_[i] == '\n';
  rest_.remove_prefix(i);
}

bool GmshText::at_end() {
  skip_space();
  return rest_.empty();
}

std::string_view GmshText::word(std::string_view what) {
  if (at_end()) fail("the text ends where there should be " + std::string(what));
  const auto end = std::ranges::find_if(rest_, is_space);
  const std::string_view word(rest_.begin(), end);
  rest_.remove_prefix(word.size());
  return word;
}

std::int64_t GmshText::integer(std::string_view what) {
  const std::string_view digits = word(what);
  std::int64_t value = 0;
  // The smallest number of all has no opposite.
  if (!read(digits, value) || value == std::numeric_limits<std::int64_t>::min())
    fail("expected " + std::string(what) + ", a whole number, not " + in_quotes(digits));
  return value;
}

double GmshText::number(std::string_view what) {
  const std::string_view digits = word(what);
  double value = 0;
  if (!read(digits, value) || !std::isfinite(value))
    fail("expected " + std::string(what) + ", a finite number, not " + in_quotes(digits));
  return value;
}

std::size_t GmshText::count(std::string_view what, std::size_t characters_each) {
  const std::int64_t count = integer(what);
  if (count < 0) fail(std::string(what) + " must not be negative");
  if (static_cast<std::size_t>(count) > rest_.size() / characters_each)
    fail(std::string(what) + " is " + std::to_string(count) + ", but the text is too short for so many");
  return static_cast<std::size_t>(count);
}

std::string GmshText::quoted(std::string_view what) {
  skip_space();
  const std::size_t end = rest_.find_first_of("\"\n", 1);
  if (rest_.empty() || rest_[0] != '"' || end == rest_.npos || rest_[end] != '"')
    fail("expected " + std::string(what) + " between quotation marks");
  const std::string text(rest_.substr(1, end - 1));
  rest_.remove_prefix(end + 1);
  return text;
}

void GmshText::expect(std::string_view expected) {
  const std::string_view found = word(expected);
  if (found != expected) fail("expected " + std::string(expected) + ", not " + in_quotes(found));
}

void GmshText::skip_past(std::string_view end) {
  while (word(end) != end) {
  }
}

}  // namespace signorini::api
