#pragma once

#include "api/result/result_document.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// The members of results that a request picks (`?fields=`). Throws HttpError 400.
api::ResultFields fields_of(const Request& request);

/// The same before a reply is begun, as no status could follow then: throws HttpError 400 if a result with so
/// many components cannot have a picked member.
void require_available(const api::ResultFields& fields, int components);

/// The summary stands in the status: where nothing else is picked, no result is read.
bool picks_summary_alone(const Query& query);

}  // namespace signorini::server
