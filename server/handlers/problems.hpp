#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

Response validate_problem(Service& service, const Request& request);
Response list_examples(Service& service, const Request& request);
Response get_example(Service& service, const Request& request);
/// The example's picture of api/examples.
Response get_example_picture(Service& service, const Request& request);

}  // namespace signorini::server
