#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// One JSON document a line.
inline constexpr const char* ndjson_media_type = "application/x-ndjson";
/// CBOR documents one after the other (RFC 8742).
inline constexpr const char* cbor_sequence_media_type = "application/cbor-seq";

Response post_batch(Service& service, const Request& request);
Response get_batch(Service& service, const Request& request);
/// The results as the solves end.
Response get_batch_results(Service& service, const Request& request);
/// Cancels or removes its solves.
Response delete_batch(Service& service, const Request& request);

}  // namespace signorini::server
