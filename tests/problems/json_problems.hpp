#pragma once

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

/// Parts of problem documents, as clients send them.
namespace signorini::problems {

/// The vertices of a regular polygon.
inline nlohmann::json ring(int vertices, double radius = 1, double x = 0, double y = 0) {
  nlohmann::json points = nlohmann::json::array();
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * i / vertices;
    points.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return points;
}

/// Fixed all around.
inline nlohmann::json membrane_on(const nlohmann::json& domain, const nlohmann::json& mesh) {
  return {{"model", "membrane"},
          {"domain", domain},
          {"mesh", mesh},
          {"material", {{"stiffness", 1}}},
          {"boundary", {{"all", {{"type", "fixed"}}}}},
          {"scheme", "nonconforming"}};
}

}  // namespace signorini::problems
