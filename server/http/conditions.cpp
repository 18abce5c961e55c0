#include "server/http/conditions.hpp"

#include "server/http/error.hpp"

namespace signorini::server {
namespace {

bool matches(const Request& request) {
  return request.header("If-Match").value_or("*") == "*";
}

bool is_to_be_missing(const Request& request) {
  return !request.header("If-Match") && request.header("If-None-Match") == "*";
}

HttpError precondition_failed(const std::string& what) {
  return {412, {"precondition-failed", "Precondition failed", what + " Nothing was done."}};
}

}  // namespace

void require_conditions(const Request& request) {
  if (!matches(request))
    throw precondition_failed("Nothing here has an ETag, so that only `If-Match: *` holds.");
  if (is_to_be_missing(request))
    throw precondition_failed("It is there, so that `If-None-Match: *` does not hold.");
}

Response under_conditions(const Request& request, Response response) {
  if (response.status != 200 || response.later) return response;
  if (!matches(request)) require_conditions(request);
  return is_to_be_missing(request) ? Response::empty(304) : std::move(response);
}

}  // namespace signorini::server
