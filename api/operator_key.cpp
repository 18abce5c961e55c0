#include "api/operator_key.hpp"

namespace signorini::api {

std::string operator_key(const nlohmann::json& document) {
  nlohmann::json key = document;
  for (const char* const member : {"title", "load", "solver", "sweep", "study"}) key.erase(member);
  for (auto& condition : key.at("boundary"))
    for (const char* const member : {"value", "gap", "pressure"}) condition.erase(member);
  return key.dump();
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
