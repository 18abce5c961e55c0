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

  /// Throws HttpError 401 if the client does not show a token.
  void require_token(const Request& request) const;
};

/// Whether a host is reached from this machine only: `localhost`, 127.0.0.0/8 and ::1.
bool is_loopback(const std::string& host);

}  // namespace signorini::server
