#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// `GET /openapi.json`.
Response get_openapi(Service& service, const Request& request);

}  // namespace signorini::server
