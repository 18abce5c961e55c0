#include "api/document/json_document.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include "api/document/json_pointer.hpp"
#include "api/limits.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

/// `line 2, column 7` of the byte, both counted from 1; columns are bytes.
std::string place(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t last_break = before.rfind('\n');
  const std::size_t column =
      1 + (last_break == std::string_view::npos ? before.size() : before.size() - last_break - 1);
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// What the library says is wrong, without its own name for the error and without the text that it quotes,
/// which may be no UTF-8.
std::string cause(std::string message) {
  message.erase(std::min(message.find("; last read: "), message.size()));
  for (const std::string_view preamble : {"] ", "syntax error while "}) {
    const std::size_t start = message.find(preamble);
    if (start != std::string::npos) message.erase(0, start + preamble.size());
  }
  return message;
}

MalformedJson nested_too_deeply() {
  return MalformedJson("arrays and objects are nested deeper than " + std::to_string(limits::nesting) +
                       " levels");
}

/// Why the library ended the parse at this byte, the first of which is 1.
MalformedJson no_json(std::string_view text, std::size_t position, const nlohmann::detail::exception& error) {
  const std::string where = " (" + place(text, position == 0 ? 0 : position - 1) + ")";
  if (dynamic_cast<const json::out_of_range*>(&error) != nullptr)
    return MalformedJson("a number is too large: the largest is 1.7976931348623157e308" + where);
  return MalformedJson("the body is not JSON: " + cause(error.what()) + where);
}

/// Reads over a document. Two levels more than a problem may have are for the list in which problems stand.
class Skimmer : public nlohmann::json_sax<json> {
 public:
  explicit Skimmer(std::string_view text) : text_(text) {}

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return false; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    throw no_json(text_, position, error);
  }

 private:
  bool open() {
    if (++depth_ > limits::nesting + 2) throw nested_too_deeply();
    return true;
  }
  bool close() {
    --depth_;
    return true;
  }

  std::string_view text_;
  std::size_t depth_ = 0;
};

/// Whether a place in a text is in a string, byte after byte.
class PlaceInText {
 public:
  void pass(char byte) {
    if (!in_string_) {
      in_string_ = byte == '"';
      bytes_ = 0;
      return;
    }
    ++bytes_;
    if (is_escaped_)
      is_escaped_ = false;
    else if (byte == '"')
      in_string_ = false;
    else
      is_escaped_ = byte == '\\';
  }

  bool is_in_string() const { return in_string_; }
  /// Since it began.
  std::size_t bytes_of_string() const { return bytes_; }

 private:
  bool in_string_ = false, is_escaped_ = false;
  std::size_t bytes_ = 0;
};

/// Builds the document from the parser's events, and ends the parse at what this service does not take.
/// Nesting and numbers are limited while parsing: a document that is too large never comes into being.
class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, Observer* observer) : text_(text), observer_(observer) {}

  json take() { return std::move(root_); }

  /// To be told of each byte that the parser takes: it keeps a string until that ends.
  void read(char byte) {
    place_.pass(byte);
    if (place_.bytes_of_string() > limits::texts && !is_in_domain()) throw too_much_text();
  }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override {
    if (!is_in_domain() && (texts_ += value.size()) > limits::texts) throw too_much_text();
    take_memory(kOfString + value.size());
    return add(std::move(value));
  }
  bool binary(binary_t&) override { return false; }  // JSON text has none

  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (++members_ > limits::members) throw too_many(limits::members, "members of objects");
    take_memory(kOfMember + name.size());
    if (open_.back()->contains(name))
      throw MalformedJson("the member " + in_quotes(name) + " at " + in_quotes(pointer_to(pointer(), name)) +
                          " is there twice; give it once");
    names_.back() = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    throw no_json(text_, position, error);
  }

 private:
  bool add(json value) {
    insert(std::move(value));
    return true;
  }

  static MalformedJson too_many(std::size_t most, const std::string& what) {
    return MalformedJson("there are more than " + std::to_string(most) + ' ' + what +
                         " in the body; no problem has as many");
  }

  static MalformedJson too_much_text() {
    return MalformedJson("the titles and expressions may have " + std::to_string(limits::texts) +
                         " characters together and have more: shorten the expressions, or split the sweep");
  }

  bool open(json container) {
    if (open_.size() == limits::nesting) throw nested_too_deeply();
    take_memory(container.is_object() ? kOfObject : kOfArray);
    open_.push_back(insert(std::move(container)));
    names_.emplace_back();
    return true;
  }

  bool close() {
    open_.pop_back();
    names_.pop_back();
    return true;
  }

  /// Puts the value where the document has come to. Containers do not move while they are open, for
  /// nothing is added to the one around them meanwhile.
  json* insert(json value) {
    if (++values_ > limits::values) throw too_many(limits::values, "values");
    if (!is_in_mesh() && ++values_beside_mesh_ > limits::values_beside_mesh)
      throw too_many(limits::values_beside_mesh, "values outside a mesh");
    take_memory(kOfValue);
    if (observer_ && values_ % 4096 == 0 && !observer_->keep_going()) throw Cancelled();
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    json& parent = *open_.back();
    if (parent.is_object()) return &(parent[names_.back()] = std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }

  bool is_in_domain() const { return !names_.empty() && names_.front() == "domain"; }

  bool is_in_mesh() const {
    return is_in_domain() && names_.size() > 1 &&
           (names_[1] == "points" || names_[1] == "triangles" || names_[1] == "boundary");
  }

  /// Bytes of a value in a list that grows, and what it has besides, with what the allocator adds.
  static constexpr std::size_t kOfValue = 32, kOfString = 48, kOfArray = 48, kOfObject = 64, kOfMember = 80;

  /// A mesh takes some seven times the length of its text.
  void take_memory(std::size_t bytes) {
    const std::size_t most = limits::memory + limits::memory_of_byte * text_.size();
    if ((memory_ += bytes) > most)
      throw MalformedJson("the values in the body would take more than " + std::to_string(most / 1'000'000) +
                          " MB: no problem of its length has as many");
  }

  /// The pointer of the innermost open container.
  std::string pointer() const {
    std::string pointer;
    for (std::size_t level = 0; level + 1 < open_.size(); ++level)
      pointer = open_[level]->is_object() ? pointer_to(pointer, names_[level])
                                          : pointer_to(pointer, open_[level]->size() - 1);
    return pointer;
  }

  std::string_view text_;
  Observer* const observer_;
  json root_;
  std::size_t values_ = 0, values_beside_mesh_ = 0, members_ = 0, texts_ = 0, memory_ = 0;
  PlaceInText place_;
  std::vector<json*> open_;
  std::vector<std::string> names_;  ///< the member being read of each open object
};

/// A text as the parser reads it, byte by byte, which tells the builder of each.
class ReadByte {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  ReadByte(const char* at, Builder& builder) : at_(at), builder_(&builder) {}

  char operator*() const { return *at_; }
  ReadByte& operator++() {
    builder_->read(*at_);
    ++at_;
    return *this;
  }
  bool operator==(const ReadByte& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  Builder* builder_;
};

/// Walks along a text and knows what is in a string.
class Strings {
 public:
  explicit Strings(std::string_view text) : text_(text) {}

  /// To be asked from place to place.
  bool hold(std::size_t byte) {
    for (; at_ < byte; ++at_) place_.pass(text_[at_]);
    return place_.is_in_string();
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  PlaceInText place_;
};

/// The library would keep all digits of a number, and copy them into what it says of it. A look at each so
/// many bytes finds them.
void refuse_long_numbers(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  Strings strings(text);
  for (std::size_t look = limits::digits; look < text.size(); look += limits::digits) {
    std::size_t begin = look, end = look;
    while (begin > 0 && is_digit(text[begin - 1])) --begin;
    while (end < text.size() && is_digit(text[end])) ++end;
    if (end - begin > limits::digits && !strings.hold(begin))
      throw MalformedJson("a number has more than " + std::to_string(limits::digits) + " digits in a row (" +
                          place(text, begin) + ')');
    look = std::max(look, end);
  }
}

/// What the library would silently skip, or take for the end of the text.
void refuse_what_is_no_text(std::string_view text) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw MalformedJson("the body is empty; a JSON document is expected");
  if (text.starts_with("\xEF\xBB\xBF"))
    throw MalformedJson("the body starts with a byte order mark; send UTF-8 without one");
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
    throw MalformedJson("the body is not JSON: it holds a zero byte (" + place(text, zero) + ")");
}

}  // namespace

void require_json(std::string_view text) {
  refuse_what_is_no_text(text);
  refuse_long_numbers(text);
  Skimmer skimmer(text);
  json::sax_parse(text.begin(), text.end(), &skimmer);
}

json parse_json(std::string_view text, Observer* observer) {
  refuse_what_is_no_text(text);
  refuse_long_numbers(text);
  Builder builder(text, observer);
  json::sax_parse(ReadByte(text.data(), builder), ReadByte(text.data() + text.size(), builder), &builder);
  return builder.take();
}

}  // namespace signorini::api
