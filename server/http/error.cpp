#include "server/http/error.hpp"

namespace signorini::server {

Response problem_response(int status, const ProblemDetails& details) {
  Response response = Response::json(status, to_json(details, status));
  response.content_type = "application/problem+json";
  return response;
}

ProblemDetails details_of_status(int status) {
  switch (status) {
    case 400:
      return {"bad-request", "Bad request",
              "This is not an HTTP/1.1 request as RFC 9112 has them, or its head is too long."};
    case 404:
      return {"not-found", "Not found", "There is nothing at this path; GET / leads to what there is."};
    case 408:
      return {"request-timeout", "Request timeout",
              "The request did not come in time: its head within 10 s, all of a short one within 60 s."};
    case 413:
      return {"body-too-large", "Body too large",
              "The body is longer than the service takes (--max-body-bytes)."};
    case 414:
      return {"target-too-long", "Request target too long", "The path and query are longer than 8192 bytes."};
    case 416:
      return {"bad-range", "Bad range",
              "The Range header is malformed; this service sends whole documents only."};
    case 417:
      return {"bad-expectation", "Expectation failed",
              "The only expectation that can be met is 100-continue."};
    default:
      return {"http-error", "HTTP error",
              "The request was refused with status " + std::to_string(status) + "."};
  }
}

HttpError body_too_large(std::size_t max_bytes) {
  return {413,
          {"body-too-large", "Body too large",
           "The body is longer than " + std::to_string(max_bytes) +
               " bytes (--max-body-bytes), counted after decoding."}};
}

}  // namespace signorini::server
