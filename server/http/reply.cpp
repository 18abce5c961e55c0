#include "server/http/reply.hpp"

#include <array>
#include <charconv>
#include <ctime>

#include <spdlog/spdlog.h>
#include <boost/beast/http/status.hpp>

#include "server/log.hpp"

namespace signorini::server {
namespace {

/// How the end of a body is known (RFC 9112, 6.3).
enum class Delimiter { none, length, chunks, close };

/// RFC 9110, 5.6.7.
std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &utc);
  return {text.data(), size};
}

std::string phrase_of(int status) {
  const auto phrase = boost::beast::http::obsolete_reason(static_cast<boost::beast::http::status>(status));
  return {phrase.data(), phrase.size()};
}

std::string head(const Response& response, Delimiter delimiter, std::uint64_t length, bool last) {
  std::string text =
      "HTTP/1.1 " + std::to_string(response.status) + ' ' + phrase_of(response.status) + "\r\n";
  const auto add = [&](std::string_view name, std::string_view value) {
    text.append(name).append(": ").append(value).append("\r\n");
  };
  add("Date", date());
  add("Cache-Control", "no-store");
  add("Vary", "Accept, Accept-Encoding");
  add("X-Content-Type-Options", "nosniff");
  for (const auto& [name, value] : response.headers) add(name, value);
  if (!response.content_type.empty()) add("Content-Type", response.content_type);
  if (delimiter == Delimiter::length) add("Content-Length", std::to_string(length));
  if (delimiter == Delimiter::chunks) add("Transfer-Encoding", "chunked");
  if (last) add("Connection", "close");
  return text + "\r\n";
}

Delimiter delimiter_of(const Message& message, const Response& response) {
  if (response.take_connection) return Delimiter::close;
  if (response.write_body || response.parts)
    return message.version == 10 ? Delimiter::close : Delimiter::chunks;
  return response.status == 204 || response.status == 304 ? Delimiter::none : Delimiter::length;
}

/// The size line of a chunk (RFC 9112, 7.1).
std::string chunk_line(std::size_t size) {
  std::array<char, 16> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), size, 16);
  return std::string(digits.data(), end) + "\r\n";
}

/// Sends a body as it is written, what is unsent together with its first piece, and then what ends it, unless
/// more follows.
Delivery send_pieces(Connection& connection, std::string unsent, Delimiter delimiter,
                     const BodyWriter& write_body, const std::function<bool()>& is_complete) {
  const bool chunked = delimiter == Delimiter::chunks;
  const bool written = write_body([&](std::string_view piece) {
    if (piece.empty()) return true;
    if (chunked) unsent += chunk_line(piece.size());
    unsent += piece;
    if (chunked) unsent += "\r\n";
    const bool taken = connection.send(unsent);
    unsent.clear();
    return taken;
  });
  const bool complete = written && is_complete();
  if (complete && chunked) unsent += "0\r\n\r\n";
  if (written && connection.send(unsent)) return complete ? Delivery::whole : Delivery::part;
  spdlog::info("the client left before the reply ended");
  return Delivery::failed;
}

/// What `send` does, and the reason in the log if that throws.
template <typename Send>
Delivery broken_off_on_failure(const std::string& log_id, const Send& send) {
  const LogField request("request", log_id);
  try {
    return send();
  } catch (const std::exception& error) {
    spdlog::error("the reply broke off: {}", error.what());
    return Delivery::failed;
  }
}

}  // namespace

bool goes_on(const Message& message, const Response& response) {
  return message.may_follow && delimiter_of(message, response) != Delimiter::close;
}

std::string reply_text(const Message& message, const Response& response) {
  const bool last = !goes_on(message, response);
  std::string text = head(response, delimiter_of(message, response), response.body.size(), last);
  if (message.method != "HEAD") text += response.body;
  return text;
}

bool send_written_reply(Connection& connection, const Message& message, const Response& response,
                        const std::string& log_id) {
  connection.begin_reply(response.in_the_way);
  return broken_off_on_failure(log_id, [&] {
           return send_pieces(connection, reply_text(message, response), delimiter_of(message, response),
                              response.write_body, [] { return true; });
         }) == Delivery::whole;
}

Delivery send_parts(Connection& connection, const Message& message, const Response& response, bool first,
                    const std::string& log_id) {
  connection.begin_reply(response.in_the_way);
  PartSource& parts = *response.parts;
  return broken_off_on_failure(log_id, [&] {
    return send_pieces(
        connection, first ? reply_text(message, response) : "", delimiter_of(message, response),
        [&](const PieceSink& sink) { return parts.write(sink); }, [&] { return parts.is_complete(); });
  });
}

}  // namespace signorini::server
