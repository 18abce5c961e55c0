#include "api/operator_key.hpp"

namespace signorini::api {

std::string operator_key(const nlohmann::json& document) {
  nlohmann::json key = document;
  for (const char* const member : {"title", "load", "solver", "sweep", "study"}) key.erase(member);
  for (auto& condition : key.at("boundary"))
    for (const char* const member : {"value", "gap", "pressure"}) condition.erase(member);
  return key.dump();
}

std::string load_key(const nlohmann::json& load, const nlohmann::json& boundary) {
  nlohmann::json key = boundary;
  for (auto& condition : key) condition.erase("gap");
  return key.dump() + load.dump();
}

}  // namespace signorini::api
