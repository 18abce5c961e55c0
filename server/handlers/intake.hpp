#pragma once

#include <string>
#include <vector>

#include "api/problem/problem_json.hpp"
#include "server/handlers/service.hpp"
#include "server/http/error.hpp"
#include "server/http/request.hpp"
#include "solve.hpp"

namespace signorini::server {

/// A problem that was sent and may be solved here.
struct Intake {
  std::string text;  ///< as JSON
  api::Request request;
  Estimates foreseen;

  /// Bytes that solving it will take, about: the runs of a study follow each other.
  double memory() const;
};

/// Gives back to the system what a document has taken, once it is read: each thread's heap would keep it,
/// tens of times a body's length, and there are tens of threads.
class ReleasedMemory {
 public:
  explicit ReleasedMemory(std::size_t body) : is_much_(body > 1 << 17) {}
  ~ReleasedMemory();

  ReleasedMemory(const ReleasedMemory&) = delete;
  ReleasedMemory& operator=(const ReleasedMemory&) = delete;

 private:
  const bool is_much_;
};

/// Whether the head declares a body that take_in() can read. Throws HttpError 415 if it does not.
void require_readable(const Request& request);

/// The body of a request as JSON. Throws HttpError 415, 413, 400.
std::string json_body(const Request& request, std::size_t max_bytes);

/// Reads a problem and says what it costs. Throws HttpError 413 if it is larger than the service takes, what
/// api::parse_request throws, and Cancelled if the client leaves.
Intake judge(std::string text, const Request& request, const Limits& limits);

/// Reads the problem in the body of a request, JSON or CBOR. Throws HttpError 415, 413 (bytes or unknowns),
/// 400, and what api::parse_request throws.
Intake take_in(Service& service, const Request& request);

/// Nobody hears it, but it stands in the log.
HttpError client_left();

/// The same of a problem that must have a study: throws InvalidProblem if it has none.
Intake take_in_study(Service& service, const Request& request);

}  // namespace signorini::server
