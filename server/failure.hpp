#pragma once

#include <exception>

#include "server/problem_details.hpp"

namespace signorini::server {

/// Something that did not work, as a client may see it.
struct Failure {
  int status;  ///< the HTTP status, if a request is refused with it
  ProblemDetails details;
};

/// Words for an exception of the solver, the formats or the machine. The text of an exception that
/// nobody foresaw stays inside: it goes to the log, where the fields of this thread lead to it.
Failure describe(const std::exception_ptr& error);

}  // namespace signorini::server
