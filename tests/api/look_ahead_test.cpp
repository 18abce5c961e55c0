// What is said of a problem before it is solved is what the solve says.
#include <gtest/gtest.h>

#include "../problems/json_problems.hpp"
#include "../problems/no_cache.hpp"
#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"
#include "solve.hpp"

namespace signorini::api::look_ahead_test {
namespace {

using nlohmann::json;
using problems::membrane_on;

json membrane(int divisions = 4) {
  json problem = membrane_on({{"type", "rectangle"}}, {{"divisions", {divisions, divisions}}});
  problem["boundary"] = {{"left", {{"type", "fixed"}}}, {"bottom", {{"type", "contact"}, {"gap", 0.05}}}};
  problem["solver"] = {{"method", "active_set"}};
  return problem;
}

json block(int divisions = 4) {
  json problem = membrane(divisions);
  problem["model"] = "elasticity";
  problem["material"] = {{"young", 1}, {"poisson", 0.3}};
  return problem;
}

/// Both say the same; answers what.
std::vector<std::string> agreed(const json& problem) {
  const Request request = parse_request(problem.dump());
  const auto said = pointers_of(faults_of([&] { look_ahead(request.problem, request.sweep); }));
  Observer observer;
  NoCache cache;
  const auto found = pointers_of(
      faults_of([&] { solve(request.problem, request.sweep, request.settings, observer, cache); }));
  EXPECT_EQ(said, found) << problem.dump();
  return found;
}

json with(json problem, const std::string& pointer, const json& value) {
  problem[json::json_pointer(pointer)] = value;
  return problem;
}

using Pointers = std::vector<std::string>;

TEST(LookAhead, FindsWhatOnlyTheRealMeshShows) {
  const std::string dip = "1-2*exp(-1e3*((x-0.4123)^2+(y-0.3331)^2))",
                    hole = "log((x-0.4123)^2+(y-0.3331)^2-1e-4)";
  EXPECT_EQ(agreed(with(membrane(32), "/material/stiffness", dip)), Pointers{"/material/stiffness"});
  EXPECT_EQ(agreed(with(block(32), "/material/young", dip)), Pointers{"/material/young"});
  EXPECT_EQ(agreed(with(block(32), "/material/poisson", "0.3*(" + dip + ")-0.8")),
            Pointers{"/material/poisson"});
  EXPECT_EQ(agreed(with(membrane(32), "/load/body", hole)), Pointers{"/load/body"});
  EXPECT_EQ(agreed(with(membrane(32), "/boundary/top", {{"type", "traction"}, {"value", "log(x-0.002)"}})),
            Pointers{"/boundary/top/value"});
  EXPECT_EQ(agreed(with(membrane(32), "/boundary/bottom/gap", "0.1+log(x-0.002)^2")),
            Pointers{"/boundary/bottom/gap"});
  json swept = membrane(32);
  swept["sweep"] = {{{"load", {{"body", 1}}}},
                    {{"load", {{"body", hole}}}},
                    {{"boundary", {{"bottom", {{"gap", "0.1+log(x-0.002)^2"}}}}}}};
  const Request request = parse_request(swept.dump());
  EXPECT_EQ(pointers_of(faults_of([&] { look_ahead(request.problem, request.sweep); })),
            (Pointers{"/sweep/1/load/body", "/sweep/2/boundary/bottom/gap"}));
  Observer observer;
  NoCache cache;
  const auto entries = solve(request.problem, request.sweep, request.settings, observer, cache).sweep;
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0].error, "");
  EXPECT_TRUE(entries[1].error.starts_with("/sweep/1/load/body ")) << entries[1].error;
  EXPECT_TRUE(entries[2].error.starts_with("/sweep/2/boundary/bottom/gap ")) << entries[2].error;
}

/// Points between those that the discrete problem asks are the certificate's, which says what it makes of
/// them.
TEST(LookAhead, RefusesNothingForOtherPoints) {
  const std::string spike = "1-2*exp(-1e6*((x-0.4123)^2+(y-0.3331)^2))";
  for (const json& problem :
       {with(membrane(), "/boundary/top", {{"type", "traction"}, {"value", "log(x)"}}),
        with(membrane(), "/material/stiffness", "abs(x-0.4123)"),
        with(membrane(), "/material/stiffness", "x==0.25?0:1"), with(block(), "/material/young", spike),
        with(block(), "/material/poisson", "0.3*(" + spike + ")-0.8"),
        with(membrane(), "/load/body", "1/(x-0.37)"),
        with(membrane(), "/boundary/bottom/gap", "0.1+1/abs(x-0.37)")})
    EXPECT_EQ(agreed(problem), Pointers{});
  json swept = membrane();
  swept["sweep"] = {{{"load", {{"body", "1/(x-0.37)"}}}}};
  EXPECT_EQ(agreed(swept), Pointers{});
}

TEST(LookAhead, SaysWhatItLeavesToTheSolve) {
  const auto left = [](const json& problem) {
    return look_ahead(parse_request(problem.dump()).problem).size();
  };
  EXPECT_EQ(left(membrane(32)), 0u);
  EXPECT_EQ(left(membrane(64)), 1u);
  std::string formula = "1";
  while (formula.size() < 900) formula += "+1/sin(7*x)";  // no enclosure tells that it is finite
  EXPECT_EQ(left(with(membrane(), "/load/body", formula)), 1u);
  EXPECT_EQ(left(with(membrane(32), "/load/body", formula)), 2u);
  std::string bounded = "1";
  while (bounded.size() < 900) bounded += "+sin(7*x)";
  EXPECT_EQ(left(with(membrane(32), "/load/body", bounded)), 1u);
}

}  // namespace
}  // namespace signorini::api::look_ahead_test
