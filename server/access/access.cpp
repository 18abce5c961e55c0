#include "server/access/access.hpp"

#include <cmath>
#include <sstream>

#include "server/http/error.hpp"

namespace signorini::server {

namespace {

HttpError too_often(const std::string& limit, std::chrono::duration<double> wait) {
  return {429,
          {"too-many-requests", "Too many requests",
           limit + " Wait, or ask for several things at once: a sweep, a list, a stream of events."},
          {{"Retry-After", std::to_string(static_cast<long>(std::ceil(wait.count())))}}};
}

std::string in_words(double per_second) {
  std::ostringstream text;
  text << "More than " << per_second << " requests a second came from ";
  return text.str();
}

HttpError unauthorized(bool shown) {
  return {401,
          {"unauthorized", "Unauthorized",
           shown ? "The Authorization header holds none of the tokens of this service (--token-file)."
                 : "This service wants a token (--token-file): send `Authorization: Bearer TOKEN`."},
          {{"WWW-Authenticate", "Bearer"}}};
}

/// RFC 6750, 3.1.
HttpError out_of_scope(const std::string& name, Scope scope) {
  const std::string wanted = scope == Scope::read ? "read" : scope == Scope::solve ? "solve" : "metrics";
  return {403,
          {"insufficient-scope", "The token is not for this",
           "The token of `" + name + "` has no scope `" + wanted + "`, which this takes (--token-file)."},
          {{"WWW-Authenticate", "Bearer error=\"insufficient_scope\", scope=\"" + wanted + "\""}}};
}

}  // namespace

void Access::count(const Request& request) {
  const auto wait = rate.count(request.remote_address, RequestRate::Clock::now());
  if (wait.count() <= 0) return;
  throw too_often(in_words(rate.per_second()) + "this address, which is the limit (--rate).", wait);
}

Identity Access::require(const Request& request, Scope scope) const {
  const auto authorization = request.header("Authorization");
  std::optional<Identity> identity = tokens.identify(authorization);
  if (!identity) throw unauthorized(authorization.has_value());
  if (!identity->may(scope)) throw out_of_scope(identity->name, scope);
  return *std::move(identity);
}

void Access::count(const Identity& identity) const {
  const auto wait = tokens.count(identity);
  if (wait.count() > 0)
    throw too_often(in_words(identity.rate) + "`" + identity.name + "`, which is its limit (--token-file).",
                    wait);
}

}  // namespace signorini::server
