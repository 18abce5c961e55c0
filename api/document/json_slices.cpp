#include "api/document/json_slices.hpp"

#include <nlohmann/json.hpp>

namespace signorini::api {
namespace {

/// Goes through a text from value to value.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  /// Takes the character, if it is the next one but for blanks.
  bool take(char wanted) {
    pass_blanks();
    if (at_ == text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }

  /// The next value.
  std::string_view value() {
    pass_blanks();
    const std::size_t begin = at_;
    int depth = 0;
    do {
      const char c = text_[at_];
      if (c == '"') {
        pass_string();
      } else if (is_structural(c)) {
        depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
        ++at_;
      } else {
        ++at_;
      }
    } while (at_ < text_.size() && (depth > 0 || goes_on(begin)));
    return text_.substr(begin, at_ - begin);
  }

 private:
  static bool is_structural(char c) { return std::string_view("{}[],:").find(c) != std::string_view::npos; }
  static bool is_blank(char c) { return std::string_view(" \t\r\n").find(c) != std::string_view::npos; }

  /// Whether a number or a word that began there has not ended yet.
  bool goes_on(std::size_t begin) const {
    const bool is_word = !is_structural(text_[begin]) && text_[begin] != '"';
    return is_word && !is_structural(text_[at_]) && !is_blank(text_[at_]);
  }

  void pass_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  void pass_string() {
    for (++at_; text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<std::pair<std::string, std::string_view>> member_slices(std::string_view object) {
  std::vector<std::pair<std::string, std::string_view>> members;
  Scanner scanner(object);
  if (!scanner.take('{') || scanner.take('}')) return members;
  do {
    std::string name = nlohmann::json::parse(scanner.value()).get<std::string>();
    scanner.take(':');
    members.emplace_back(std::move(name), scanner.value());
  } while (scanner.take(','));
  return members;
}

std::vector<std::string_view> element_slices(std::string_view array) {
  std::vector<std::string_view> elements;
  Scanner scanner(array);
  if (!scanner.take('[') || scanner.take(']')) return elements;
  do elements.push_back(scanner.value());
  while (scanner.take(','));
  return elements;
}

}  // namespace signorini::api
