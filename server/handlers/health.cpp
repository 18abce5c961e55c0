#include "server/handlers/health.hpp"

#include "server/http/error.hpp"

namespace signorini::server {

Response healthz(Service&, const Request&) {
  return Response::json(200, "{\"status\":\"ok\"}");
}

Response readyz(Service& service, const Request&) {
  if (!service.scheduler.accepting()) {
    throw HttpError(503, {"stopping", "The service is stopping", "It takes no more solves."},
                    {{"Retry-After", "10"}});
  }
  if (const auto trouble = service.store.trouble()) throw StoreUnavailable(*trouble);
  return Response::json(
      200, "{\"status\":\"ready\",\"damaged_solves\":" + std::to_string(service.store.damaged()) + "}");
}

}  // namespace signorini::server
