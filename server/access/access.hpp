#pragma once

#include "server/access/bearer_tokens.hpp"
#include "server/access/cors.hpp"
#include "server/access/known_hosts.hpp"
#include "server/access/request_rate.hpp"

namespace signorini::server {

/// Who may ask, and how often.
struct Access {
  BearerTokens tokens;
  RequestRate rate{0};
  Cors cors;
  KnownHosts hosts = {};

  /// Throws HttpError 429 if the client asks too often.
  void count(const Request& request);

  /// Throws HttpError 421 or 403 if a page of another site may be behind the request.
  void require_known_host(const Request& request) const { hosts.require(request, cors); }

  /// Throws HttpError 401 if the client does not show a token.
  void require_token(const Request& request) const;
};

}  // namespace signorini::server
