#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "server/http/response.hpp"
#include "server/problem_details.hpp"

namespace signorini::server {

/// Ends a request with a status of 400 or more and the reason as problem+json.
class HttpError : public std::runtime_error {
 public:
  HttpError(int http_status, ProblemDetails problem,
            std::vector<std::pair<std::string, std::string>> extra_headers = {})
      : std::runtime_error(problem.detail),
        status(http_status),
        details(std::move(problem)),
        headers(std::move(extra_headers)) {}

  int status;
  ProblemDetails details;
  std::vector<std::pair<std::string, std::string>> headers;
};

/// The problem+json reply.
Response problem_response(int status, const ProblemDetails& details);

/// 400: what is wrong with the request.
HttpError bad_request(const std::string& detail);

/// 400: two who read the request could disagree about its end.
HttpError ambiguous_length();

/// 404: no route has the path.
HttpError not_found();

/// 408
HttpError request_timeout();

/// 503: so many long bodies came before that this one was neither let in nor read in time.
HttpError too_many_bodies();

/// 413: more bytes than --max-body-bytes.
HttpError body_too_large(std::size_t max_bytes);

}  // namespace signorini::server
