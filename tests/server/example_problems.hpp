#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/examples.hpp"

namespace signorini::server {

/// The problem document of an example.
inline nlohmann::json example(const std::string& wanted) {
  for (const api::Example& each : api::examples()) {
    if (each.name == wanted) return nlohmann::json::parse(each.json);
  }
  ADD_FAILURE() << "no example " << wanted;
  return {};
}

/// The paper's problem by the active set, most of whose time goes into one factorisation.
inline nlohmann::json paper_problem(int divisions) {
  nlohmann::json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {divisions, divisions};
  problem["solver"] = {{"method", "active_set"}};
  return problem;
}

/// The paper's problem in steps so small that it iterates for longer than any test.
inline nlohmann::json endless_problem() {
  nlohmann::json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {80, 80};
  problem["solver"] = {{"method", "uzawa"},
                       {"rho", 1e-6},
                       {"augmentation", 1},
                       {"tolerance", 1e-14},
                       {"max_iterations", 1'000'000}};
  return problem;
}

}  // namespace signorini::server
