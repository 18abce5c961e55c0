#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problem/problem.hpp"
#include "problem/settings.hpp"
#include "problem/study.hpp"
#include "progress/observer.hpp"

namespace signorini::api {

/// A problem as a client poses it: what to solve, how, and under which title.
struct Request {
  std::string title;
  std::vector<std::string> tags;  ///< by which solves are found again
  Problem problem;
  Settings settings;
  std::vector<Variation> sweep;
  std::optional<Study> study;
};

/// Reads a problem document (api/README.md, "A problem"). Throws MalformedJson if the text is no JSON, and
/// InvalidProblem with every fault found, each with its JSON pointer and the allowed values: of the
/// document, and if it has none, those that validate() of the solver sees, of a long sweep in the first
/// entries. An observer, if there is one, is asked as the text is read and may end that: throws Cancelled.
Request parse_request(std::string_view text, Observer* observer = nullptr);

}  // namespace signorini::api
