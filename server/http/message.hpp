#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/error.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// A request as it came from the wire (RFC 9112, 2.1), framed and checked; its body is whole and still has
/// its content coding. A message that is refused holds what could be read of it.
struct Message {
  int version = 11;  ///< 10 or 11
  std::string method;
  std::string target;  ///< as sent
  std::string host;    ///< the host and port for which the request is, without regard to where that was said
  std::string path;    ///< in which nothing is percent-encoded that need not be
  std::string query;   ///< without the question mark, as sent
  Headers headers;
  std::string body;
  bool chunked = false;
  bool body_left = false;   ///< the body was not read to its end
  bool may_follow = false;  ///< whether the connection can take another request after it
  std::optional<HttpError> refusal;
};

/// 501
HttpError unknown_method();

/// Understands HTTP/1.2 to 1.9 as HTTP/1.1 (RFC 9110, 2.5), of which the parser knows nothing: writes so in a
/// head. Throws HttpError 505 for another major version.
void lower_version(std::string& head);

/// What RFC 9110 and 9112 ask of the head of a request beyond its grammar, which the parser has checked;
/// where they leave a choice, what is not exact is refused. Reads the target into host, path and query.
/// Throws HttpError.
void apply_rules(Message& message);

/// Whether the client waits for "100 Continue" before it sends its body. Throws HttpError 417 where it
/// expects something else.
bool expects_continue(const Message& message);

/// The elements of all headers of this name (RFC 9110, 5.6.1), which have no comma within.
std::vector<std::string> list_of(const Headers& headers, std::string_view name);

}  // namespace signorini::server
