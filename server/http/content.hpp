#pragma once

#include "server/http/response.hpp"

namespace signorini::server {

/// Writes a body of at most 64 KiB beforehand: it is sent whole, with its length, and what goes wrong while
/// it is written can still be told by the status.
void take_if_short(Response& response);

/// Compresses the body by gzip, if there is one and it is long enough to gain by it.
void compress(Response& response);

}  // namespace signorini::server
