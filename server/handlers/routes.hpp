#pragma once

#include "server/handlers/service.hpp"
#include "server/http/router.hpp"

namespace signorini::server {

/// The route table of the service, which must outlive it.
Router routes(Service& service);

}  // namespace signorini::server
