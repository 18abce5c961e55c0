#include "reply_reader.hpp"

#include <charconv>
#include <optional>

namespace signorini::server {
namespace {

std::string_view header(std::string_view head, std::string_view name) {
  const std::string line = "\r\n" + std::string(name) + ": ";
  const std::size_t found = head.find(line);
  if (found == std::string_view::npos) return {};
  const std::string_view value = head.substr(found + line.size());
  return value.substr(0, value.find("\r\n"));
}

std::size_t number(std::string_view text, int base) {
  std::size_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

/// Takes the chunks off the text; nothing if they have not ended.
std::optional<std::string> take_chunks(std::string_view& text) {
  std::string body;
  for (;;) {
    const std::size_t line = text.find("\r\n");
    if (line == std::string_view::npos) return std::nullopt;
    const std::size_t size = number(text.substr(0, line), 16);
    if (text.size() < line + 2 + size + 2) return std::nullopt;
    body += text.substr(line + 2, size);
    text.remove_prefix(line + 2 + size + 2);
    if (size == 0) return body;
  }
}

}  // namespace

std::vector<Reply> read_replies(std::string_view heard, bool to_head) {
  std::vector<Reply> replies;
  while (!heard.empty()) {
    const std::size_t end = heard.find("\r\n\r\n");
    if (end == std::string_view::npos) break;
    if (!heard.starts_with("HTTP/1.1 ")) {
      replies.push_back({0, std::string(heard), {}});
      break;
    }
    Reply reply{static_cast<int>(number(heard.substr(9, 3), 10)), std::string(heard.substr(0, end + 2)), {}};
    heard.remove_prefix(end + 4);
    const bool has_body = !(to_head && reply.status >= 200) && reply.status >= 200 && reply.status != 204;
    if (reply.status >= 200) to_head = false;
    if (has_body && !header(reply.head, "Transfer-Encoding").empty()) {
      const std::optional<std::string> body = take_chunks(heard);
      if (!body) break;
      reply.body = *body;
    } else if (has_body) {
      const std::size_t length = number(header(reply.head, "Content-Length"), 10);
      if (heard.size() < length) break;
      reply.body = heard.substr(0, length);
      heard.remove_prefix(length);
    }
    replies.push_back(std::move(reply));
  }
  return replies;
}

}  // namespace signorini::server
