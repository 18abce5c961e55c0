#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace signorini::api {

/// Reads the words of a .msh file one by one, and knows the line. Everything that it does not find throws
/// InvalidProblem at `/domain/msh` with the line.
class GmshText {
 public:
  explicit GmshText(std::string_view text) : rest_(text) {}

  /// The line of the word read last, from 1.
  int line() const { return line_; }

  /// Whether nothing but space is left.
  bool at_end();

  /// The next word; `what` says what it should be.
  std::string_view word(std::string_view what);

  std::int64_t integer(std::string_view what);
  double number(std::string_view what);

  /// A count of things each of which takes at least so many characters of what is left of the text.
  std::size_t count(std::string_view what, std::size_t characters_each);

  /// A text between quotation marks.
  std::string quoted(std::string_view what);

  /// Reads a given word.
  void expect(std::string_view word);

  /// Leaves out everything up to a word.
  void skip_past(std::string_view word);

  [[noreturn]] void fail(std::string detail) const { fail_at(line_, std::move(detail)); }
  [[noreturn]] static void fail_at(int line, std::string detail);

 private:
  void skip_space();

  std::string_view rest_;
  int line_ = 1;
};

}  // namespace signorini::api
