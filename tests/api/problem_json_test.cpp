#include "api/problem/problem_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/examples.hpp"
#include "faults_of.hpp"

namespace signorini::api::problem_json_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json minimal() {
  return json::parse(R"({
    "model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [4, 4]},
    "material": {"stiffness": 1}, "boundary": {"left": {"type": "fixed"}}, "scheme": "conforming"})");
}

/// The minimal problem with one member changed.
Request parse_with(const std::string& pointer, const json& value) {
  json document = minimal();
  document[json::json_pointer(pointer)] = value;
  return parse_request(document.dump());
}

std::string only_detail(const std::string& pointer, const json& value) {
  const auto faults = faults_of([&] { parse_with(pointer, value); });
  return faults.size() == 1 ? faults.front().detail : std::to_string(faults.size()) + " faults";
}

template <typename Kind>
const Kind& condition(const Request& request, const std::string& part) {
  return std::get<Kind>(request.problem.boundary.at(part));
}

TEST(ParseRequest, ReadsThePaper) {
  for (const Example& example : examples()) {
    if (example.name != "paper-nonconforming") continue;
    const Request request = parse_request(example.json);
    const Problem& problem = request.problem;
    EXPECT_EQ(request.title, "The paper, section 6, nonconforming");
    EXPECT_EQ(std::get<Rectangle>(problem.domain).origin, Point(0, 0));
    EXPECT_EQ(std::get<Rectangle>(problem.domain).size, Vector(1, 1));
    EXPECT_EQ(std::get<Divisions>(problem.mesh.fineness).x, 12);
    EXPECT_EQ(problem.mesh.pattern, Pattern::right);
    EXPECT_EQ(std::get<MembraneStiffness>(problem.material).xx(Point(0, 0)), 1);
    EXPECT_EQ(problem.body(0, Point(0.4, 0)), 10);
    EXPECT_EQ(problem.body(0, Point(0.6, 0)), -10);
    EXPECT_EQ(condition<Fixed>(request, "left").value(0, Point(0, 0)), 0);
    EXPECT_EQ(condition<Contact>(request, "top").gap(Point(0, 0)), 0);
    EXPECT_EQ(problem.scheme, Scheme::nonconforming);
    const auto& uzawa = std::get<PaperUzawa>(request.settings.method);
    EXPECT_EQ(uzawa.rho, 0.1);
    EXPECT_EQ(uzawa.augmentation, 1);
    EXPECT_EQ(uzawa.initial_displacement, 0.5);
    EXPECT_EQ(uzawa.tolerance, 1e-5);
    EXPECT_EQ(uzawa.max_iterations, 1000);
    return;
  }
  FAIL() << "the example is missing";
}

TEST(ParseRequest, HasTheDefaultsOfTheContract) {
  const Request request = parse_request(minimal().dump());
  EXPECT_EQ(request.title, "");
  EXPECT_EQ(request.problem.body(0, Point(0, 0)), 0);
  EXPECT_EQ(std::get<Rectangle>(request.problem.domain).size, Vector(1, 1));
  EXPECT_EQ(request.problem.boundary.size(), 1u);
  EXPECT_EQ(request.problem.mesh.pattern, Pattern::right);
  EXPECT_TRUE(std::holds_alternative<Mprgp>(request.settings.method));
  EXPECT_FALSE(request.settings.time_limit);
}

TEST(ParseRequest, ReadsEveryNameOfATable) {
  EXPECT_EQ(parse_with("/mesh/pattern", "left").problem.mesh.pattern, Pattern::left);
  EXPECT_EQ(parse_with("/mesh/pattern", "alternating").problem.mesh.pattern, Pattern::alternating);
  EXPECT_EQ(parse_with("/mesh/pattern", "crossed").problem.mesh.pattern, Pattern::crossed);
  EXPECT_EQ(parse_with("/scheme", "nonconforming").problem.scheme, Scheme::nonconforming);
}

TEST(ParseRequest, ReadsTheFinenessInBothForms) {
  const Request request = parse_with("/mesh", {{"size", 0.25}});
  EXPECT_EQ(std::get<LargestEdge>(request.problem.mesh.fineness).length, 0.25);
  EXPECT_EQ(std::get<Divisions>(parse_with("/mesh/divisions", {3, 5.0}).problem.mesh.fineness).y, 5);
}

TEST(ParseRequest, ReadsAStiffnessMatrixOfExpressions) {
  const auto stiffness = std::get<MembraneStiffness>(
      parse_with("/material/stiffness", json::parse(R"([["2 + x", 0.5], [0.5, 3]])")).problem.material);
  EXPECT_EQ(stiffness.xx(Point(1, 0)), 3);
  EXPECT_EQ(stiffness.xy(Point(1, 0)), 0.5);
  EXPECT_EQ(stiffness.yy(Point(1, 0)), 3);
  EXPECT_EQ(stiffness.xx.name(), "/material/stiffness/0/0");
}

TEST(ParseRequest, AllNamesThePartsThatAreNotNamed) {
  const Request request = parse_request(R"({
    "model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [4, 4]},
    "material": {"stiffness": 1}, "scheme": "conforming",
    "boundary": {"all": {"type": "contact", "gap": "1 + ny"}, "top": {"type": "traction", "value": -2}}})");
  EXPECT_EQ(request.problem.boundary.size(), 4u);
  EXPECT_EQ(condition<Traction>(request, "top").value(0, Point(0, 0)), -2);
  for (const char* part : {"left", "right", "bottom"})
    EXPECT_EQ(condition<Contact>(request, part).gap(Point(0, 0), Vector(0, -1)), 0) << part;
}

TEST(ParseRequest, NumbersDecideTheFormOfUzawa) {
  const auto method = [](const json& solver) { return parse_with("/solver", solver).settings.method; };
  EXPECT_TRUE(std::holds_alternative<PaperUzawa>(method({{"rho", 0.1}, {"augmentation", 0}})));
  EXPECT_TRUE(std::holds_alternative<Mprgp>(method({{"rho", "auto"}, {"augmentation", "auto"}})));
  EXPECT_TRUE(std::holds_alternative<Mprgp>(method({{"method", "uzawa"}, {"rho", "auto"}})));
  const auto accelerated = std::get<Mprgp>(method({{"tolerance", 1e-12}, {"max_iterations", 7}}));
  EXPECT_EQ(accelerated.tolerance, 1e-12);
  EXPECT_EQ(accelerated.max_iterations, 7);
  EXPECT_EQ(std::get<ActiveSet>(method({{"method", "active_set"}, {"max_iterations", 9}})).max_iterations, 9);
}

TEST(ParseRequest, ReadsTheTimeLimitOfEveryMethod) {
  EXPECT_EQ(parse_with("/solver", {{"time_limit", 0.5}}).settings.time_limit, 0.5);
  EXPECT_EQ(parse_with("/solver", {{"method", "active_set"}, {"time_limit", 2}}).settings.time_limit, 2);
}

TEST(ParseRequest, SaysWhatIsAllowed) {
  EXPECT_THAT(only_detail("/mesh/pattern", "rihgt"), HasSubstr("right, left, alternating, crossed"));
  EXPECT_THAT(only_detail("/mesh/pattern", "rihgt"), HasSubstr("did you mean \"right\"?"));
  EXPECT_THAT(only_detail("/boundary/left", {{"type", "fixed"}, {"gap", 1}}),
              HasSubstr("allowed are: type, value"));
  EXPECT_THAT(only_detail("/boundary/lift", {{"type", "fixed"}}), HasSubstr("left, right, bottom, top, all"));
  EXPECT_THAT(only_detail("/boundary/lift", {{"type", "fixed"}}), HasSubstr("did you mean \"left\"?"));
  EXPECT_THAT(only_detail("/model", "plate"), HasSubstr("membrane"));
  EXPECT_THAT(only_detail("/material/stiffness", nullptr), HasSubstr("not null"));
  EXPECT_THAT(only_detail("/mesh/size", 0.1), HasSubstr("either size"));
  EXPECT_THAT(only_detail("/mesh/divisions", {10000, 10000}), HasSubstr("40000000 triangles"));
  EXPECT_THAT(only_detail("/solver", {{"rho", 0.1}}), HasSubstr("rho is one"));
}

TEST(ParseRequest, TheSizeThatARefusalNamesIsAccepted) {
  const std::string detail = only_detail("/mesh", {{"size", 1e-5}});
  const double sensible = std::stod(detail.substr(detail.rfind(' ')));
  EXPECT_GT(sensible, 1e-5);
  EXPECT_NO_THROW(parse_with("/mesh", {{"size", 1.01 * sensible}}));
  EXPECT_NO_THROW(parse_with("/mesh", {{"size", 1.01 * sensible}, {"pattern", "crossed"}}));
}

TEST(ParseRequest, CountsTheTitleInCharacters) {
  std::string title;
  for (int i = 0; i < 200; ++i) title += "ä";
  EXPECT_EQ(parse_with("/title", title).title, title);
  EXPECT_THAT(only_detail("/title", title + "ä"), HasSubstr("it has 201"));
}

TEST(ParseRequest, KeepsAReplySmall) {
  json document = minimal();
  for (int i = 0; i < 10'000; ++i) document["m" + std::to_string(i)] = 0;
  const auto faults = faults_of([&] { parse_request(document.dump()); });
  ASSERT_EQ(faults.size(), 101u);
  EXPECT_THAT(faults.back().detail, HasSubstr("9900 more"));
  EXPECT_LT(only_detail("/model", std::string(900'000, 'x')).size(), 200u);
}

TEST(ParseRequest, CutsAQuotationBetweenCharacters) {
  std::string word = "a";
  for (int i = 0; i < 100; ++i) word += "ä";
  EXPECT_NO_THROW(json(only_detail("/model", word)).dump());
}

}  // namespace
}  // namespace signorini::api::problem_json_test
