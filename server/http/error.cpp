#include "server/http/error.hpp"

namespace signorini::server {

Response problem_response(int status, const ProblemDetails& details) {
  Response response = Response::json(status, to_json(details, status));
  response.content_type = "application/problem+json";
  return response;
}

HttpError bad_request(const std::string& detail) {
  return {400, {"bad-request", "Bad request", detail}};
}

HttpError ambiguous_length() {
  return {400,
          {"ambiguous-length", "Ambiguous length",
           "Send either one Content-Length with a number or `Transfer-Encoding: chunked`."}};
}

HttpError not_found() {
  return {404, {"not-found", "Not found", "There is nothing at this path; GET / leads to what there is."}};
}

HttpError request_timeout() {
  return {
      408,
      {"request-timeout", "Request timeout",
       "The request did not come in time: its head within 10 s, all of a short one within 60 s, a long body "
       "within 300 s and with 16 KiB a second while others wait to send theirs."}};
}

HttpError too_many_bodies() {
  return {
      503,
      {"too-many-bodies", "Too many long bodies",
       "Within 30 s nobody came to read this body, for others came before; bodies up to 32 KiB that are not "
       "compressed do not wait behind them."},
      {{"Retry-After", "10"}}};
}

HttpError body_too_large(std::size_t max_bytes) {
  return {413,
          {"body-too-large", "Body too large",
           "The body is longer than " + std::to_string(max_bytes) +
               " bytes (--max-body-bytes), counted after decoding."}};
}

}  // namespace signorini::server
