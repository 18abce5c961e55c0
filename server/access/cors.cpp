#include "server/access/cors.hpp"

#include <algorithm>

namespace signorini::server {

bool Cors::is_preflight(const Request& request) const {
  const auto origin = request.header("Origin");
  return request.method == "OPTIONS" && origin && allows(*origin) &&
         request.header("Access-Control-Request-Method").has_value();
}

Response Cors::answer_preflight(const std::string& methods) {
  Response response = Response::empty(204);
  response.headers = {
      {"Access-Control-Allow-Methods", methods},
      {"Access-Control-Allow-Headers",
       "Authorization, Content-Type, Content-Encoding, Idempotency-Key, If-Match, Last-Event-ID, Prefer, "
       "Traceparent, X-Request-Id"},
      {"Access-Control-Max-Age", "600"}};
  return response;
}

void Cors::mark(const Request& request, Response& response) const {
  if (origins_.empty()) return;
  response.headers.emplace_back("Vary", "Origin");
  const auto origin = request.header("Origin");
  if (!origin || !allows(*origin)) return;
  response.headers.emplace_back("Access-Control-Allow-Origin", *origin);
  response.headers.emplace_back(
      "Access-Control-Expose-Headers",
      "Content-Disposition, Location, Preference-Applied, Retry-After, X-Request-Id");
}

bool Cors::allows(const std::string& origin) const {
  return std::ranges::any_of(origins_, [&](const auto& each) { return each == origin || each == "*"; });
}

}  // namespace signorini::server
