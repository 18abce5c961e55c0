#include "server/http/message_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

// Beast asserts that a last chunk comes with two bytes after its line (basic_parser.ipp, parse_chunk_header),
// where it only reads them again when there are.
#define BOOST_DISABLE_ASSERTS
#include <boost/beast/http/basic_parser.hpp>

namespace signorini::server {
namespace {

namespace http = boost::beast::http;
using boost::beast::error_code;
using boost::beast::string_view;

HttpError head_too_long(const MessageLimits& limits) {
  return {431,
          {"head-too-long", "Head too long",
           "The head or the trailers of the request are longer than " + std::to_string(limits.head) +
               " bytes or have more than " + std::to_string(limits.headers) + " fields."}};
}

HttpError target_too_long(const MessageLimits& limits) {
  return {414,
          {"target-too-long", "Request target too long",
           "The path and query are longer than " + std::to_string(limits.target) + " bytes."}};
}

HttpError refusal_of(const error_code& error, const MessageLimits& limits) {
  if (error == http::error::body_limit) return body_too_large(limits.body);
  if (error == http::error::bad_content_length || error == http::error::bad_transfer_encoding) {
    return ambiguous_length();
  }
  return bad_request("This is not an HTTP/1.1 request as RFC 9112 has them: " + error.message() + ".");
}

/// An obsolete fold (RFC 9112, 5.2).
HttpError folded_trailer() {
  return bad_request("A line of the trailers begins with a blank.");
}

std::string text_of(string_view text) {
  return {text.data(), text.size()};
}

/// Of a head that is not whole, or cannot be read: a reply to HEAD has no body, whatever it is (RFC 9110,
/// 9.3.2).
std::string method_of_head(std::string_view head) {
  return head.starts_with("HEAD ") ? "HEAD" : "";
}

}  // namespace

/// Beast's parser, which gives what it reads to a message.
class MessageReader::Parser : public http::basic_parser<true> {
 public:
  Parser(Message& message, const MessageLimits& limits) : message_(message), limits_(limits) {
    header_limit(static_cast<std::uint32_t>(limits.head + 1));
    // Ours tells more. No limit at all would be one that nothing meets: Beast 1.74 compares with boost::none.
    body_limit(std::numeric_limits<std::uint64_t>::max());
  }

  /// Reads what it can of the bytes, and takes it off them. Throws HttpError.
  void read(std::string& bytes) {
    error_code error;
    reading_ = bytes;
    const std::size_t count = put(boost::asio::const_buffer(bytes.data(), bytes.size()), error);
    bytes.erase(0, count);
    if (error && error != http::error::need_more) throw refusal_of(error, limits_);
  }

 private:
  void on_request_impl(http::verb, string_view method, string_view target, int version,
                       error_code&) override {
    message_.method = text_of(method);
    message_.target = text_of(target);
    message_.version = version;
    if (target.size() > limits_.target) throw target_too_long(limits_);
  }

  void on_response_impl(int, string_view, int, error_code&) override {}

  void on_field_impl(http::field, string_view name, string_view value, error_code&) override {
    if (++fields_ > limits_.headers) throw head_too_long(limits_);
    // A trailer says nothing that this service asks for (RFC 9110, 6.5.1).
    if (!in_body_) message_.headers.emplace(text_of(name), text_of(value));
  }

  void on_header_impl(error_code&) override { in_body_ = true; }
  void on_body_init_impl(const boost::optional<std::uint64_t>&, error_code&) override {}

  std::size_t on_body_impl(string_view piece, error_code&) override {
    message_.body.append(piece.data(), piece.size());
    return piece.size();
  }

  void on_chunk_header_impl(std::uint64_t size, string_view extensions, error_code&) override {
    if (size > limits_.body - message_.body.size()) throw body_too_large(limits_.body);
    extension_bytes_ += extensions.size();
    if (extension_bytes_ > limits_.extensions) throw bad_request("The chunks have too many extensions.");
    const auto is_control = [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == '\x7f'; };
    if (std::ranges::any_of(extensions, is_control)) {
      throw bad_request("A chunk extension holds a control character.");
    }
    if (size == 0) refuse_folds(reading_.substr(extensions.data() + extensions.size() - reading_.data()));
  }

  std::size_t on_chunk_body_impl(std::uint64_t, string_view piece, error_code& error) override {
    return on_body_impl(piece, error);
  }

  void on_finish_impl(error_code&) override {}

  /// Of the trailers, which are there to their end, behind the line of the last chunk: Beast would unfold
  /// them.
  static void refuse_folds(std::string_view rest) {
    const std::string_view trailers = rest.substr(0, rest.find("\r\n\r\n"));
    if (trailers.find("\n ") != std::string_view::npos || trailers.find("\n\t") != std::string_view::npos)
      throw folded_trailer();
  }

  Message& message_;
  const MessageLimits& limits_;
  std::string_view reading_;  ///< while it reads
  bool in_body_ = false;
  std::size_t fields_ = 0;
  std::size_t extension_bytes_ = 0;
};

MessageReader::MessageReader(const MessageLimits& limits) : limits_(limits) {}

MessageReader::~MessageReader() = default;

void MessageReader::take(std::string_view bytes) {
  if (ended_) return;
  bytes_ += bytes;
  advance();
}

void MessageReader::advance() {
  try {
    if (stage_ == Stage::nothing || stage_ == Stage::head) look_for_end_of_head();
    if (stage_ == Stage::body) read_body();
  } catch (const HttpError& error) {
    refuse(error);
  }
}

/// Judges line ends on the way: Beast would fold lines and, of a head without a sound end, never see one.
void MessageReader::look_for_end_of_head() {
  while (scanned_ < bytes_.size()) {
    const char before = scanned_ > 0 ? bytes_[scanned_ - 1] : '\0';
    const char c = bytes_[scanned_++];
    if ((before == '\r') != (c == '\n')) throw bad_request("A line does not end with CR and LF together.");
    if (before == '\n' && (c == ' ' || c == '\t'))
      throw bad_request("A line of the head begins with a blank.");
    if (c != '\n') continue;
    if (scanned_ == 2) {
      skip_empty_line();
    } else if (++line_ends_ > 1 && bytes_[scanned_ - 3] == '\n') {
      return read_head(scanned_);
    }
  }
  stage_ = bytes_.empty() ? Stage::nothing : Stage::head;
  constexpr std::size_t around_target = 32;
  if (line_ends_ == 0 && scanned_ > limits_.target + around_target) {
    throw bytes_.find(' ') == std::string::npos ? unknown_method() : target_too_long(limits_);
  }
  if (scanned_ >= limits_.head) throw head_too_long(limits_);
}

/// Some clients send one after a body (RFC 9112, 2.2).
void MessageReader::skip_empty_line() {
  constexpr std::size_t most = 4;
  if (++empty_lines_ > most) throw bad_request("The request begins with too many empty lines.");
  bytes_.erase(0, scanned_);
  scanned_ = 0;
}

void MessageReader::read_head(std::size_t size) {
  if (size > limits_.head) throw head_too_long(limits_);
  std::string head = bytes_.substr(0, size);
  message_.method = method_of_head(head);
  bytes_.erase(0, size);
  head_bytes_ = size;
  lower_version(head);
  parser_ = std::make_unique<Parser>(message_, limits_);
  parser_->read(head);
  apply_rules(message_);
  // Two who read the same header must find the same body.
  if (!head.empty() || !parser_->is_header_done() || parser_->chunked() != message_.chunked) {
    throw bad_request("The head cannot be read.");
  }
  expects_continue_ = server::expects_continue(message_);
  if (awaited() > limits_.body) throw body_too_large(limits_.body);
  message_.may_follow = parser_->keep_alive() && message_.version > 10;
  parser_->eager(true);
  stage_ = Stage::body;
}

void MessageReader::read_body() {
  if (!parser_->is_done() && !bytes_.empty()) parser_->read(bytes_);
  if (parser_->is_done()) return end_message();
  if (message_.chunked && !bytes_.empty()) judge_rest_of_chunks();
}

/// The parser has left the line of a chunk, or the last one with its trailers, of which the end is not there:
/// what it would refuse then is refused now.
void MessageReader::judge_rest_of_chunks() const {
  const std::size_t line = bytes_.starts_with("\r\n") ? 2 : 0;
  for (std::size_t end = line; (end = bytes_.find('\n', end)) != std::string::npos; ++end) {
    if (end == line || bytes_[end - 1] != '\r')
      throw bad_request("A line does not end with CR and LF together.");
    if (end + 1 < bytes_.size() && (bytes_[end + 1] == ' ' || bytes_[end + 1] == '\t'))
      throw folded_trailer();
  }
  const std::size_t after_zeros = std::min(bytes_.find_first_not_of('0', line), bytes_.size() - 1);
  const bool complete = bytes_.find('\n', line) != std::string::npos;
  if (complete && std::string_view("\r; \t").find(bytes_[after_zeros]) == std::string_view::npos) {
    throw bad_request("The size of a chunk is no hexadecimal number.");
  }
  if (!complete && bytes_.size() > limits_.chunk_line) {
    throw bad_request("The line of a chunk is longer than " + std::to_string(limits_.chunk_line) + " bytes.");
  }
  if (bytes_.size() > limits_.head) throw head_too_long(limits_);
}

void MessageReader::end_message() {
  parser_.reset();
  stage_ = Stage::whole;
}

void MessageReader::refuse(const HttpError& reason) {
  if (message_.method.empty()) message_.method = method_of_head(bytes_);
  message_.refusal = reason;
  leave_body();
}

void MessageReader::leave_body() {
  ended_ = true;
  bytes_ = {};
  message_.body = {};
  message_.body_left = true;
  message_.may_follow = false;
  end_message();
}

std::uint64_t MessageReader::awaited() const {
  return parser_ ? parser_->content_length_remaining().value_or(0) : 0;
}

std::uint64_t MessageReader::longest_body() const {
  return message_.chunked ? limits_.body : message_.body.size() + awaited();
}

bool MessageReader::expects_continue() const {
  return expects_continue_ && stage_ == Stage::body && message_.body.empty() && bytes_.empty();
}

Message MessageReader::next() {
  Message whole = std::exchange(message_, {});
  scanned_ = line_ends_ = empty_lines_ = head_bytes_ = 0;
  stage_ = Stage::nothing;
  expects_continue_ = false;
  advance();
  return whole;
}

std::size_t MessageReader::size() const {
  constexpr std::size_t around_header = 128;
  return bytes_.size() + head_bytes_ + message_.headers.size() * around_header + message_.body.size();
}

}  // namespace signorini::server
