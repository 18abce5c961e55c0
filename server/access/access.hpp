#pragma once

#include "server/access/bearer_tokens.hpp"
#include "server/access/cors.hpp"
#include "server/access/request_rate.hpp"

namespace signorini::server {

/// Who may ask, and how often.
struct Access {
  BearerTokens tokens;
  RequestRate rate{0};
  Cors cors;

  /// Throws HttpError 429 if the client asks too often.
  void count(const Request& request);

  /// Who sends it, if it may do so. Throws HttpError 401 if no token is shown, 403 if it is not for this
  /// scope, and 429 if its name asks too often.
  Identity require(const Request& request, Scope scope) const;
};

/// Whether a host is reached from this machine only: `localhost`, 127.0.0.0/8 and ::1.
bool is_loopback(const std::string& host);

}  // namespace signorini::server
