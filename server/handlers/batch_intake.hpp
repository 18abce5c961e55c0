#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/jobs/batch.hpp"

namespace signorini::server {

/// Reads the batch in the body of a request, JSON or CBOR, as take_in() does a problem; there is never more
/// than one of its problems in memory that is more than a text. Throws what take_in() throws, with pointers
/// into the batch, and HttpError 413 if reading it takes too long.
NewBatch take_in_batch(Service& service, const Request& request);

}  // namespace signorini::server
