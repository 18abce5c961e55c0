#include "server/problem_details.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "server/json_text.hpp"

namespace signorini::server {
namespace {

std::string without_controls(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char byte) { return byte < 0x20 || byte == 0x7f; }, ' ');
  return text;
}

}  // namespace

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

std::string to_text(const ProblemDetails& details) {
  std::string text =
      without_controls(details.title + ":" + (details.errors.empty() ? " " + details.detail : ""));
  for (const FaultItem& item : details.errors)
    text += "\n  " + without_controls(item.where + " " + item.detail);
  return text;
}

std::string error_to_json(const std::optional<ProblemDetails>& error) {
  return error ? to_json(*error, status_of(*error)) : "";
}

}  // namespace signorini::server
