#pragma once

#include "server/http/connection.hpp"
#include "server/http/error.hpp"
#include "server/http/router.hpp"

namespace signorini::server {

/// What the router is to know of a message, except for its body.
Request request_of(const Connection& connection, const Message& message);

/// Answers a request: routes it, turns whatever is thrown into problem+json, writes the line of the log.
/// Never throws. A reply that is promised for later is made by resume().
Response dispatch(const Router& router, Request& request);

/// Makes a reply that was promised.
Response resume(const Router& router, const Request& request, const LaterReply& promised);

/// Does what is to be done when the client leaves that was promised a reply. Never throws.
void leave(const Request& request, const LaterReply& promised);

/// Answers a request that is refused before any route is asked.
Response refuse(const Router& router, const Request& request, const HttpError& refusal);

}  // namespace signorini::server
