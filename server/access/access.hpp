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

  /// Who sends it, if it may do so. Throws HttpError 401 if no token is shown, 403 if it is not for this
  /// scope.
  Identity require(const Request& request, Scope scope) const;

  /// Throws HttpError 429 if the name asks too often.
  void count(const Identity& identity) const;
};

}  // namespace signorini::server
