#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace signorini::api {

/// Problems that are posted together.
struct Batch {
  std::string title;
  std::vector<std::string> tags;  ///< of each problem, beside its own
};

/// Reads a problem of a batch, a JSON text that stands in it at the pointer.
using ReadProblem =
    std::function<void(const Batch& batch, std::string_view problem, const std::string& pointer)>;

/// Reads a batch (api/README.md, "A batch"), its problems by the function, one after the other. Throws
/// MalformedJson if the text is no JSON, or a problem none as parse_json() takes it; and InvalidProblem with
/// all faults: its own, and those that the function throws, behind the pointers of their problems.
Batch parse_batch(std::string_view text, const ReadProblem& read);

/// Adds the tags of a batch to those of one of its problems. Throws InvalidProblem if they are too many then.
void add_tags(const std::vector<std::string>& of_batch, std::vector<std::string>& tags);

}  // namespace signorini::api
