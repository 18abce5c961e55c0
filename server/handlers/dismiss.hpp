#pragma once

#include <span>
#include <string>

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// What became of many solves that a client does not want any more.
struct Dismissed {
  std::size_t cancelled = 0, deleted = 0;
};

/// Cancels those that have not ended, and removes the others, some at a time.
Dismissed dismiss(Service& service, std::span<const std::string> ids);

/// Tells the client, and the log.
Response dismissed_response(const Request& request, const Dismissed& dismissed);

}  // namespace signorini::server
