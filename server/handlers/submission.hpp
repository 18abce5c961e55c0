#pragma once

#include <optional>
#include <string>

#include "server/handlers/intake.hpp"
#include "server/handlers/service.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// The key by which a client may send its request again without solving the problem twice. Throws HttpError
/// 400.
std::optional<std::string> idempotency_key(const Request& request);

/// The job that solves a problem, for the one who sends the request.
NewJob new_job(Service& service, const Request& request, Intake intake);

/// Queues the job and returns its id, or that of the earlier one with the same key and problem. Throws
/// HttpError 422, 429 and 503.
std::string submit(Service& service, const Request& request, NewJob job);

/// The same of a batch, as a whole. Throws HttpError 413 besides if it could never be queued.
Batch submit(Service& service, const Request& request, NewBatch batch);

}  // namespace signorini::server
