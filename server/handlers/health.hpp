#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// Whether the process answers.
Response healthz(Service& service, const Request& request);

/// Whether new solves are taken.
Response readyz(Service& service, const Request& request);

}  // namespace signorini::server
