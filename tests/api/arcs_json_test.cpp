// Arcs and circles of a polygon as JSON has them.
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"
#include "mesh/domain_mesh.hpp"

namespace signorini::api::arcs_json_test {
namespace {

using nlohmann::json;

json slotted() {
  return json::parse(R"({
    "model": "elasticity",
    "domain": {"type": "polygon",
      "vertices": [{"at": [-1, 1], "arc": {"centre": [0, 1]}}, [1, 1], {"at": [0.5, 1]}, {"at": [-0.5, 1], "arc": {"centre": [-0.75, 1.1], "long": true}}],
      "holes": [{"circle": {"centre": [0, 0.5], "radius": 0.25}}, [[0.6, 0.6], [0.7, 0.6], {"at": [0.7, 0.7], "arc": {"centre": [0.65, 0.65]}}]],
      "sides": ["arc", "top", "top", "ear"]},
    "mesh": {"size": 0.2}, "material": {"young": 1, "poisson": 0.3},
    "boundary": {"top": {"type": "fixed"}, "hole0": {"type": "contact"}}, "scheme": "conforming"})");
}

std::vector<std::string> pointers_with(const std::string& pointer, const json& value) {
  json document = slotted();
  document[json::json_pointer(pointer)] = value;
  return pointers_of(faults_of([&] { parse_request(document.dump()); }));
}

TEST(ArcsJson, AreRead) {
  const Polygon polygon = std::get<Polygon>(parse_request(slotted().dump()).problem.domain);
  EXPECT_EQ(polygon.vertices, (std::vector<Point>{{-1, 1}, {1, 1}, {0.5, 1}, {-0.5, 1}}));
  ASSERT_EQ(polygon.arcs.size(), 4u);
  EXPECT_EQ(polygon.arcs[0].centre, Point(0, 1));
  EXPECT_FALSE(polygon.arcs[0].is_long);
  EXPECT_EQ(polygon.arcs[1].vertex, 3);
  EXPECT_TRUE(polygon.arcs[1].is_long);
  EXPECT_EQ(polygon.arcs[2].ring, 1);
  EXPECT_EQ(polygon.arcs[2].centre, Point(0, 0.5));
  EXPECT_EQ(polygon.arcs[3].ring, 2);
  EXPECT_EQ(polygon.arcs[3].vertex, 2);
  EXPECT_EQ(polygon.holes[0], (std::vector<Point>{{0.25, 0.5}}));
  EXPECT_EQ(part_names(Domain(polygon)), (std::vector<std::string>{"arc", "top", "ear", "hole0", "hole1"}));
}

TEST(ArcsJson, FaultsHaveTheirPointers) {
  using Pointers = std::vector<std::string>;
  const std::string first = "/domain/vertices/0", circle = "/domain/holes/0/circle";
  EXPECT_EQ(pointers_with(first + "/arc/center", json({0, 1})), Pointers{first + "/arc/center"});
  EXPECT_EQ(pointers_with(first + "/arc", json::object()), Pointers{first + "/arc/centre"});
  EXPECT_EQ(pointers_with(first + "/arc", 1), Pointers{first + "/arc"});
  EXPECT_EQ(pointers_with(first + "/arc/centre", json({0, "a"})), Pointers{first + "/arc/centre/1"});
  EXPECT_EQ(pointers_with(first + "/arc/centre", json({0.1, 1})), Pointers{first + "/arc/centre"});
  EXPECT_EQ(pointers_with(first + "/arc/long", 1), Pointers{first + "/arc/long"});
  EXPECT_EQ(pointers_with(first + "/radius", 1), Pointers{first + "/radius"});
  EXPECT_EQ(pointers_with(first, json::object()), Pointers{first + "/at"});
  EXPECT_EQ(pointers_with(first, "a"), Pointers{first});
  EXPECT_EQ(pointers_with(circle + "/radius", 0), Pointers{circle + "/radius"});
  EXPECT_EQ(pointers_with(circle + "/radius", -1), Pointers{circle + "/radius"});
  EXPECT_EQ(pointers_with(circle + "/arc", 1), Pointers{circle + "/arc"});
  EXPECT_EQ(pointers_with(circle, json::object()), (Pointers{circle + "/centre", circle + "/radius"}));
  EXPECT_EQ(pointers_with("/domain/holes/0", json::object()), Pointers{circle});
  EXPECT_EQ(pointers_with("/domain/holes/0", 1), Pointers{"/domain/holes/0"});
}

/// Whatever numbers a polygon has, as far as numbers go: it is read, or has a fault.
TEST(ArcsJson, OfAnySizeAreReadOrHaveFaults) {
  std::mt19937 engine(1);
  const auto number = [&] {
    const double size = std::pow(10, std::uniform_real_distribution<>(-308, 308)(engine));
    return engine() % 4 == 0 ? static_cast<double>(engine() % 3) : engine() % 2 == 0 ? size : -size;
  };
  int read = 0, faulty = 0;
  for (int i = 0; i < 3000; ++i) {
    json document = slotted();
    for (json& vertex : document["domain"]["vertices"]) {
      json& at = vertex.is_array() ? vertex : vertex["at"];
      if (engine() % 3 == 0) at = {number(), number()};
      if (vertex.contains("arc") && engine() % 2 == 0) vertex["arc"]["centre"] = {number(), number()};
    }
    if (engine() % 2 == 0)
      document["domain"]["holes"][0] = {
          {"circle", {{"centre", {number(), number()}}, {"radius", std::abs(number())}}}};
    if (engine() % 2 == 0) document["mesh"]["size"] = std::abs(number());
    try {
      parse_request(document.dump());
      ++read;
    } catch (const InvalidProblem&) {
      ++faulty;
    }
  }
  EXPECT_EQ(read + faulty, 3000);
  EXPECT_GT(read, 0);
}

/// So nearly straight that their first chords pass by each other.
TEST(ArcsJson, ThatCrossOnceTheyAreMeshedHaveFaults) {
  json document = json::parse(R"({
    "model": "membrane", "domain": {"type": "polygon", "vertices": [
      {"at": [1, 0], "arc": {"centre": [30.5, 30.5]}}, [0, 1],
      {"at": [-1, 0], "arc": {"centre": [29.5, 29.5]}}, {"at": [0, -1], "arc": {"centre": [0.501, -0.501]}}]},
    "mesh": {"size": 0.5}, "material": {"stiffness": 1}, "boundary": {"side0": {"type": "fixed"}},
    "scheme": "conforming"})");
  const auto faults = faults_of([&] { parse_request(document.dump()); });
  EXPECT_EQ(pointers_of(faults), std::vector<std::string>{"/domain/vertices/3"});
  ASSERT_FALSE(faults.empty());
  EXPECT_NE(faults.front().detail.find("the arc from (0, -1) to (1, 0)"), std::string::npos);
}

TEST(ArcsJson, HaveOperatorsOfTheirOwn) {
  json document = json::parse(R"({
    "model": "membrane", "domain": {"type": "polygon", "vertices": [{"at": [1, 0], "arc": {"centre": [0, 0]}}, [0, 1], [0, 0]]},
    "mesh": {"size": 0.5}, "material": {"stiffness": 1}, "boundary": {"side1": {"type": "fixed"}}, "scheme": "conforming"})");
  const std::string short_arc = parse_request(document.dump()).problem.operator_key;
  document["domain"]["vertices"][0]["arc"]["centre"] = {2, 2};
  EXPECT_NE(parse_request(document.dump()).problem.operator_key, short_arc);
  document["domain"]["vertices"][0] = {1, 0};
  EXPECT_NE(parse_request(document.dump()).problem.operator_key, short_arc);
}

}  // namespace
}  // namespace signorini::api::arcs_json_test
