#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "server/access/identity.hpp"
#include "server/http/trace.hpp"

namespace signorini::server {

struct CaseInsensitive {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const;
};

using Headers = std::multimap<std::string, std::string, CaseInsensitive>;
using Query = std::multimap<std::string, std::string>;

/// Reads the body, decoded, of at most so many bytes. Throws HttpError if it is longer or broken.
using BodyReader = std::function<std::string(std::size_t max_bytes)>;

/// One request, free of the HTTP library.
struct Request {
  std::string remote_address;  ///< of the client, or of the proxy before it
  Identity identity;           ///< who sends it; by the router
  std::string id;              ///< X-Request-Id, of the client or made here
  std::optional<Trace> trace;  ///< if the client sent a traceparent
  std::string method;
  std::string path;    ///< without the query; nothing in it is percent-encoded that need not be
  std::string target;  ///< as sent, for the log
  std::string host;    ///< and port for which it is
  Query query;
  Headers headers;
  BodyReader read_body;
  std::function<bool()> client_left;  ///< whether nobody waits for the reply any more
  std::chrono::steady_clock::time_point begun;
  bool accepts_gzip = false;
  std::string reply_type;  ///< the media type that the client prefers, of those of the route; by the router
  std::string route;       ///< the pattern that the path matches; by the router
  std::map<std::string, std::string> path_parameters;  ///< filled by the router

  /// All values of a header as one list, as RFC 9110 5.3 joins them; nothing if it is not there.
  std::optional<std::string> header(std::string_view name) const;
};

}  // namespace signorini::server
