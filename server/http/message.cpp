#include "server/http/message.hpp"

#include <strings.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include <arpa/inet.h>

namespace signorini::server {
namespace {

bool equals(std::string_view a, std::string_view b) {
  return a.size() == b.size() && strncasecmp(a.data(), b.data(), a.size()) == 0;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::optional<int> value_of_hex(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

// RFC 3986, 2.2 and 2.3.
bool is_unreserved(char c) {
  return is_letter(c) || is_digit(c) || std::string_view("-._~").find(c) != std::string_view::npos;
}

/// The octet that a percent sign and two digits at this place stand for; nothing if they do not stand there.
std::optional<char> encoded_at(std::string_view text, std::size_t at) {
  if (text[at] != '%' || at + 2 >= text.size()) return std::nullopt;
  const auto high = value_of_hex(text[at + 1]), low = value_of_hex(text[at + 2]);
  if (!high || !low) return std::nullopt;
  return static_cast<char>(16 * *high + *low);
}

/// Whether the text holds these characters, unreserved ones and percent-encoded octets only.
bool holds_only(std::string_view text, std::string_view others) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '%' && encoded_at(text, i)) {
      i += 2;
    } else if (!is_unreserved(c) && others.find(c) == std::string_view::npos) {
      return false;
    }
  }
  return true;
}

constexpr std::string_view of_names = "!$&'()*+,;=";
constexpr std::string_view of_paths = "!$&'()*+,;=:@/";
constexpr std::string_view of_queries = "!$&'()*+,;=:@/?";

/// The path, in which `%7E` and `~` are the same (RFC 3986, 6.2.2.2).
std::string without_needless_codes(std::string_view path) {
  std::string plain;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto octet = encoded_at(path, i);
    const bool needless = octet && is_unreserved(*octet);
    plain += needless ? *octet : path[i];
    if (needless) i += 2;
  }
  return plain;
}

bool is_port(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return text.empty() || (error == std::errc() && end == text.data() + text.size() && port <= 65535);
}

/// An address in brackets (RFC 3986, 3.2.2): IPv6, as no other kind has been agreed on.
bool is_address(std::string_view text) {
  in6_addr address{};
  return inet_pton(AF_INET6, std::string(text).c_str(), &address) == 1;
}

/// `host [ ":" port ]` (RFC 9110, 7.2). A host that is empty names nothing (RFC 9110, 4.2.1).
bool is_host(std::string_view text) {
  std::size_t end = 0;
  if (text.starts_with('[')) {
    end = text.find(']');
    if (end == std::string_view::npos || !is_address(text.substr(1, end - 1))) return false;
    ++end;
  } else {
    end = std::min(text.find(':'), text.size());
    if (end == 0 || !holds_only(text.substr(0, end), of_names)) return false;
  }
  return end == text.size() || (text[end] == ':' && is_port(text.substr(end + 1)));
}

void check_method(const std::string& method) {
  constexpr std::array known{"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE"};
  if (std::ranges::find(known, method) == known.end()) throw unknown_method();
}

/// RFC 9112, 3.2: a request names its host once, an old one may leave it out.
void read_host(Message& message) {
  const auto [first, last] = message.headers.equal_range("Host");
  const auto count = std::distance(first, last);
  if (count > 1) throw bad_request("The request has more than one Host.");
  if (count == 0 && message.version == 10) return;
  if (count == 0) throw bad_request("The request has no Host, which HTTP/1.1 asks for: `Host: localhost`.");
  if (!is_host(first->second)) throw bad_request("The Host is not a name or address with or without a port.");
  message.host = first->second;
}

/// RFC 9110, 7.4.
HttpError not_secured() {
  return {
      421,
      {"misdirected", "Misdirected request",
       "The request is for an https URI, but its connection is not secured; a proxy that is should send the "
       "path alone."}};
}

/// Takes scheme and authority off an absolute target; what they say counts, and not the Host (RFC
/// 9112, 3.2.2).
std::string_view origin_form(std::string_view target, Message& message) {
  if (target.starts_with('/')) return target;
  const std::size_t scheme = target.find("://");
  const std::string_view name = target.substr(0, scheme);
  if (scheme != std::string_view::npos && equals(name, "https")) throw not_secured();
  if (scheme == std::string_view::npos || !equals(name, "http")) {
    throw bad_request("The request target must be a path that begins with a slash, or an http URI.");
  }
  target.remove_prefix(scheme + 3);
  const std::size_t end = std::min(target.find_first_of("/?"), target.size());
  if (!is_host(target.substr(0, end))) throw bad_request("The request target has no valid host.");
  message.host = target.substr(0, end);
  return target.substr(end);
}

void read_target(Message& message) {
  if (message.target == "*" && message.method == "OPTIONS") {
    message.path = "*";
    return;
  }
  const std::string_view target = origin_form(message.target, message);
  const std::size_t end = std::min(target.find('?'), target.size());
  const std::string_view path = target.substr(0, end);
  const std::string_view query = target.substr(std::min(end + 1, target.size()));
  if (!holds_only(path, of_paths) || !holds_only(query, of_queries)) {
    throw bad_request(
        "The request target holds a character that must be percent-encoded in it (RFC 3986), or a percent "
        "sign without two hexadecimal digits.");
  }
  message.path = path.empty() ? "/" : without_needless_codes(path);
  message.query = query;
}

/// The parser has refused what is no number, but takes the same one several times.
void check_length(const Message& message) {
  const auto [first, last] = message.headers.equal_range("Content-Length");
  const bool sound =
      first == last || (std::next(first) == last && std::ranges::all_of(first->second, is_digit));
  if (!sound) throw ambiguous_length();
}

/// RFC 9112, 6.1 and 6.3.
void read_coding(Message& message) {
  if (!message.headers.contains("Transfer-Encoding")) return;
  const std::vector<std::string> codings = list_of(message.headers, "Transfer-Encoding");
  const auto is_chunked = [](const std::string& coding) { return equals(coding, "chunked"); };
  const bool sound = message.version > 10 && !message.headers.contains("Content-Length") &&
                     std::ranges::count_if(codings, is_chunked) == 1 && is_chunked(codings.back());
  if (!sound) throw ambiguous_length();
  if (codings.size() > 1) {
    throw HttpError(501, {"coding-not-implemented", "Transfer coding not implemented",
                          "The only transfer coding that this service reads is `chunked`; a body may be "
                          "sent with `Content-Encoding: gzip`."});
  }
  message.chunked = true;
}

}  // namespace

HttpError unknown_method() {
  return {501,
          {"method-not-implemented", "Method not implemented",
           "This service knows no such method; it answers GET, HEAD, POST, DELETE and OPTIONS, in capital "
           "letters."}};
}

void lower_version(std::string& head) {
  constexpr std::string_view form = " HTTP/1.1\r\n";
  const std::size_t end = head.find("\r\n") + 2;
  if (end < form.size()) return;
  char* const version = head.data() + end - form.size();
  char& major = version[6];
  char& minor = version[8];
  const bool is_version = std::string_view(version, 6) == form.substr(0, 6) && is_digit(major) &&
                          version[7] == '.' && is_digit(minor);
  if (!is_version) return;
  if (major != '1') {
    throw HttpError(505, {"version-not-supported", "HTTP version not supported",
                          "This service speaks HTTP/1.1 and answers HTTP/1.0."});
  }
  if (minor > '1') minor = '1';
}

void apply_rules(Message& message) {
  check_method(message.method);
  read_host(message);
  read_target(message);
  check_length(message);
  read_coding(message);
}

bool expects_continue(const Message& message) {
  if (message.version == 10) return false;
  const std::vector<std::string> expected = list_of(message.headers, "Expect");
  const auto is_known = [](const std::string& each) { return equals(each, "100-continue"); };
  if (!std::ranges::all_of(expected, is_known)) {
    throw HttpError(417, {"bad-expectation", "Expectation failed",
                          "The only expectation that can be met is 100-continue."});
  }
  return !expected.empty();
}

std::vector<std::string> list_of(const Headers& headers, std::string_view name) {
  constexpr std::string_view blanks = " \t";
  std::vector<std::string> list;
  const auto [first, last] = headers.equal_range(name);
  for (auto header = first; header != last; ++header) {
    std::string_view rest = header->second;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(','), rest.size());
      std::string_view element = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      element.remove_prefix(std::min(element.find_first_not_of(blanks), element.size()));
      element = element.substr(0, element.find_last_not_of(blanks) + 1);
      if (!element.empty()) list.emplace_back(element);
    }
  }
  return list;
}

}  // namespace signorini::server
