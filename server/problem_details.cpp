#include "server/problem_details.hpp"

#include <nlohmann/json.hpp>

#include "server/json_text.hpp"

namespace signorini::server {

std::optional<int> status_of(const ProblemDetails& details) {
  return details.kind == "invalid-problem" ? std::optional(422) : std::nullopt;
}

std::string to_json(const ProblemDetails& details, std::optional<int> status) {
  nlohmann::ordered_json document;
  document["type"] = "urn:signorini:problem:" + details.kind;
  document["title"] = details.title;
  if (status) document["status"] = *status;
  document["detail"] = details.detail;
  if (details.count) document["count"] = *details.count;
  for (const FaultItem& item : details.errors) {
    document["errors"].push_back({{item.key, item.where}, {"detail", item.detail}});
  }
  return json_text(document);
}

std::string error_to_json(const std::optional<ProblemDetails>& error) {
  return error ? to_json(*error, status_of(*error)) : "";
}

}  // namespace signorini::server
