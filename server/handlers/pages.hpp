#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// `GET /`: where to go from here.
Response get_start_page(Service& service, const Request& request);

}  // namespace signorini::server
