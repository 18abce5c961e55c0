#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

Response post_solve(Service& service, const Request& request);
/// The same for a problem that must have a study.
Response post_study(Service& service, const Request& request);
Response get_solve(Service& service, const Request& request);
Response get_result(Service& service, const Request& request);
Response get_history(Service& service, const Request& request);
Response delete_solve(Service& service, const Request& request);

}  // namespace signorini::server
