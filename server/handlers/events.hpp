#pragma once

#include "server/handlers/service.hpp"
#include "server/http/error.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

inline constexpr const char* event_stream_media_type = "text/event-stream";

/// What happens to a solve, as server-sent events: `progress`, and at the end `succeeded`, `failed` or
/// `cancelled`. Goes on after the Last-Event-ID; 204 if that was the end.
Response get_events(Service& service, const Request& request);

/// 503: so many streams are open already.
HttpError too_many_subscribers(std::size_t limit);

}  // namespace signorini::server
