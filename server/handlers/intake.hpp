#pragma once

#include <string>
#include <vector>

#include "api/problem_json.hpp"
#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "solve.hpp"

namespace signorini::server {

/// A problem that was sent and may be solved here.
struct Intake {
  std::string text;  ///< as JSON
  api::Request request;
  Estimate estimate;
  std::vector<Estimate> runs;  ///< of its study

  /// Bytes that solving it will take, about: the runs of a study follow each other.
  double memory() const;
};

/// Whether the head declares a body that take_in() can read. Throws HttpError 415 if it does not.
void require_readable(const Request& request);

/// Reads the problem in the body of a request, JSON or CBOR. Throws HttpError 415, 413 (bytes or unknowns),
/// 400, and what api::parse_request throws.
Intake take_in(Service& service, const Request& request);

/// The same of a problem that must have a study: throws InvalidProblem if it has none.
Intake take_in_study(Service& service, const Request& request);

}  // namespace signorini::server
