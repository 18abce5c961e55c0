#pragma once

#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// Nothing here has an ETag, so that of the conditions of RFC 9110, 13.1, only `If-Match: *` holds, and
/// `If-None-Match: *` does not. To be called when what is asked for is there, before it is changed. Throws
/// HttpError 412.
void require_conditions(const Request& request);

/// The same for a reply to GET or HEAD that has been made: 412, or 304 where what is asked for is known to be
/// there.
Response under_conditions(const Request& request, Response response);

}  // namespace signorini::server
