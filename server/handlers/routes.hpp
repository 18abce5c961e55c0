#pragma once

#include "server/handlers/service.hpp"
#include "server/http/router.hpp"

namespace signorini::server {

/// The route table of the service, which must outlive it.
Router routes(Service& service);

/// Those of a process that nobody but its watchers asks.
Router routes_of_worker(Service& service);

}  // namespace signorini::server
