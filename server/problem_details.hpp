#pragma once

#include <optional>
#include <string>
#include <vector>

namespace signorini::server {

/// One fault of a request. The key says what `where` is: a JSON `pointer` into the body, or the name of a
/// query `parameter`.
struct FaultItem {
  std::string key;
  std::string where;
  std::string detail;
};

/// What went wrong, in words: the reply of a refused request (RFC 9457), and the `error` of a job.
struct ProblemDetails {
  std::string kind;    ///< stable and short, e.g. `queue-full`; becomes the `type`
  std::string title;   ///< the same for every problem of the kind
  std::string detail;  ///< this occurrence: the cause and the remedy
  std::vector<FaultItem> errors = {};
  std::optional<std::size_t> count = {};  ///< of a request: how many solves it is about
};

/// The HTTP status that belongs to the error of a job: that of the refusal, if the problem itself is bad.
std::optional<int> status_of(const ProblemDetails& details);

/// `{"type", "title", "status", "detail", "count", "errors"}`; `status` only where there is an HTTP status,
/// `count` and `errors` only where there are some.
std::string to_json(const ProblemDetails& details, std::optional<int> status = std::nullopt);

/// For a person: the title, then the detail or each fault in a line. What a terminal would take for a command
/// is blank.
std::string to_text(const ProblemDetails& details);

/// The `error` of a job, with the status that belongs to it; empty if there is none.
std::string error_to_json(const std::optional<ProblemDetails>& error);

}  // namespace signorini::server
