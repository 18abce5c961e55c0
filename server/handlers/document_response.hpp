#pragma once

#include "api/document/document_writer.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// The media types of a document; the first one is for clients that do not care.
inline const std::vector<std::string> document_types{"application/json", "application/cbor"};

/// A document in the one of these types that the client prefers. `write` may be called more than once, after
/// the handler has returned.
Response document_response(const Request& request, int status, api::WriteDocument write);

}  // namespace signorini::server
