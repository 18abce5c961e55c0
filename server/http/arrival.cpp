#include "server/http/arrival.hpp"

#include <strings.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

namespace signorini::server {
namespace {

constexpr std::string_view line_end = "\r\n";
constexpr std::string_view blank_line = "\r\n\r\n";

/// The value of the first header of this name, in a head that begins with the request line.
std::optional<std::string_view> header(std::string_view head, std::string_view name) {
  for (std::size_t end; (end = head.find(line_end)) != std::string_view::npos;) {
    head.remove_prefix(end + line_end.size());
    const bool found = head.size() > name.size() && head[name.size()] == ':' &&
                       strncasecmp(head.data(), name.data(), name.size()) == 0;
    if (!found) continue;
    std::string_view value = head.substr(name.size() + 1);
    value = value.substr(0, value.find(line_end));
    value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
    return value;
  }
  return std::nullopt;
}

/// Whether the last chunk is there, or one that is none.
bool chunks_have_come(std::string_view body) {
  for (;;) {
    const std::size_t line = body.find(line_end);
    if (line == std::string_view::npos) return false;
    std::uint64_t size = 0;
    const auto [end, error] = std::from_chars(body.data(), body.data() + line, size, 16);
    if (error != std::errc() || size > body.max_size() / 2) return true;
    if (size == 0) return body.find(blank_line, line) != std::string_view::npos;
    const std::uint64_t next = line + line_end.size() + size + line_end.size();
    if (body.size() < next) return false;
    body.remove_prefix(next);
  }
}

Arrival sized_arrival(std::string_view body, std::string_view length, std::size_t longest_body) {
  std::uint64_t size = 0;
  const auto [end, error] = std::from_chars(length.data(), length.data() + length.size(), size);
  if (error != std::errc() || body.size() >= size) return Arrival::whole;
  return size > longest_body ? Arrival::long_body : Arrival::part;
}

}  // namespace

Arrival arrival_of(std::string_view bytes, std::size_t longest_head, std::size_t longest_body) {
  const std::size_t end = bytes.find(blank_line);
  if (end == std::string_view::npos) return bytes.size() < longest_head ? Arrival::part : Arrival::whole;
  const std::string_view head = bytes.substr(0, end + line_end.size());
  const std::string_view body = bytes.substr(end + blank_line.size());
  const auto length = header(head, "Content-Length");
  const auto coding = header(head, "Transfer-Encoding");
  Arrival arrival = Arrival::whole;
  if (coding == "chunked" && !length && !chunks_have_come(body)) {
    arrival = body.size() < longest_body ? Arrival::part : Arrival::long_body;
  } else if (length && !coding) {
    arrival = sized_arrival(body, *length, longest_body);
  }
  // A client that asks first sends nothing before it is told to go on.
  if (arrival == Arrival::part && header(head, "Expect")) return Arrival::long_body;
  return arrival;
}

}  // namespace signorini::server
