#include "api/problem/operator_key.hpp"

#include <algorithm>
#include <array>

namespace signorini::api {

namespace {

/// The conditions without their data.
nlohmann::json kinds_of(nlohmann::json boundary) {
  for (auto& condition : boundary)
    for (const char* const member : {"value", "gap", "pressure"}) condition.erase(member);
  return boundary;
}

}  // namespace

std::string operator_key(const nlohmann::json& document) {
  constexpr std::array others{"title", "tags", "load", "quantities", "solver", "sweep", "study"};
  std::string key;
  // Member by member, for the domain may have megabytes.
  for (const auto& [name, member] : document.items()) {
    if (std::ranges::find(others, name) != others.end()) continue;
    key.append(name).append(" ");
    key.append(name == "boundary" ? kinds_of(member).dump() : member.dump()).append("\n");
  }
  return key;
}

std::string load_key(const nlohmann::json& patch) {
  nlohmann::json key = nlohmann::json::object();
  if (patch.contains("load")) key["load"] = patch["load"];
  if (patch.contains("boundary"))
    for (const auto& [part, change] : patch["boundary"].items())
      for (const auto& [member, value] : change.items())
        if (member != "gap") key["boundary"][part][member] = value;
  return key.dump();
}

}  // namespace signorini::api
