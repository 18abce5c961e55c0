#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// `GET /metrics`, in Prometheus's text format.
Response get_metrics(Service& service, const Request& request);

}  // namespace signorini::server
