#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

Response list_solves(Service& service, const Request& request);
/// A list may be long that is to be longer than it is without a word.
Length length_of_list(const Query& query);
/// Cancels or removes all solves with a tag, once the client has said how many they are.
Response delete_tagged(Service& service, const Request& request);

}  // namespace signorini::server
