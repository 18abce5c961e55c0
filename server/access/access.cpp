#include "server/access/access.hpp"

#include <cmath>
#include <sstream>

#include "server/http/error.hpp"

namespace signorini::server {

void Access::count(const Request& request) {
  const auto wait = rate.count(request.remote_address, RequestRate::Clock::now());
  if (wait.count() <= 0) return;
  std::ostringstream detail;
  detail
      << "More than " << rate.per_second()
      << " requests a second came from this address, which is the limit (--rate). Wait, or ask for several "
         "things at once: a sweep, a list, a stream of events.";
  throw HttpError(429, {"too-many-requests", "Too many requests", detail.str()},
                  {{"Retry-After", std::to_string(static_cast<long>(std::ceil(wait.count())))}});
}

void Access::require_token(const Request& request) const {
  const auto authorization = request.header("Authorization");
  if (tokens.accept(authorization)) return;
  throw HttpError(
      401,
      {"unauthorized", "Unauthorized",
       authorization ? "The Authorization header holds none of the tokens of this service (--token-file)."
                     : "This service wants a token (--token-file): send `Authorization: Bearer TOKEN`."},
      {{"WWW-Authenticate", "Bearer"}});
}

}  // namespace signorini::server
