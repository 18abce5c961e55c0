#include "api/examples.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "api/problem/problem_json.hpp"

namespace signorini::api::examples_test {
namespace {

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const Example& example : examples()) names.emplace_back(example.name);
  return names;
}

Request example(std::string_view name) {
  for (const Example& example : examples())
    if (example.name == name) return parse_request(example.json);
  throw std::out_of_range("no such example");
}

TEST(Examples, AreTheFilesOfTheFolder) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(EXAMPLES_DIR))
    files += entry.path().extension() == ".json";
  EXPECT_EQ(examples().size(), files);
  for (const Example& example : examples()) {
    std::ostringstream text;
    text
        << std::ifstream(std::filesystem::path(EXAMPLES_DIR) / (std::string(example.name) + ".json")).rdbuf();
    EXPECT_EQ(example.json, text.str()) << example.name;
  }
}

TEST(Examples, AreSortedAndIncludeThePapers) {
  EXPECT_TRUE(std::ranges::is_sorted(names()));
  EXPECT_THAT(names(), testing::IsSupersetOf({"paper-conforming", "paper-nonconforming", "signorini-edge"}));
  EXPECT_GE(names().size(), 6u);
}

TEST(Examples, EveryOneParsesAndHasATitle) {
  for (const Example& example : examples()) {
    SCOPED_TRACE(example.name);
    EXPECT_FALSE(parse_request(example.json).title.empty());
  }
}

/// The data of the Signorini edge are those of u = Re z^(3/2): u >= 0, that is u_n <= 0, open for x > 0,
/// and pressure -sigma_n = du/dn >= 0 for x < 0.
TEST(Examples, TheSignoriniEdgeHasTheDataOfItsSolution) {
  const Request edge = example("signorini-edge");
  const VectorField& value = std::get<Fixed>(edge.problem.boundary.at("top")).value;
  const auto u = [&](const Point& x) { return value(0, x); };
  EXPECT_NEAR(u(Point(1, 0)), 1, 1e-15);
  EXPECT_NEAR(u(Point(-1, 0)), 0, 1e-15);
  EXPECT_NEAR(u(Point(0, 1)), std::cos(0.75 * 3.14159265358979), 1e-14);
  EXPECT_NEAR(u(Point(-1, 1)), std::pow(2, 0.75) * std::cos(1.125 * 3.14159265358979), 1e-14);
  const double h = 1e-6;  // outward normal (0, -1)
  const double pressure = -(u(Point(-0.25, h)) - u(Point(-0.25, 0))) / h;
  EXPECT_NEAR(pressure, 1.5 * std::sqrt(0.25), 1e-5);
  EXPECT_TRUE(std::holds_alternative<Contact>(edge.problem.boundary.at("bottom")));
}

}  // namespace
}  // namespace signorini::api::examples_test
