#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/problem/problem_json.hpp"
#include "api/result/result_document.hpp"
#include "faults_of.hpp"
#include "solve.hpp"
#include "written_by.hpp"

namespace signorini::api::sweep_json_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

json block(const json& sweep) {
  json document = json::parse(R"({
    "title": "a block", "model": "elasticity", "domain": {"type": "rectangle", "size": [2, 1]},
    "mesh": {"divisions": [4, 2]}, "material": {"young": 3, "poisson": 0.3}, "load": {"body": [0, "-x"]},
    "boundary": {"left": {"type": "roller"}, "bottom": {"type": "contact", "gap": 0.1},
                 "top": {"type": "traction", "value": [0, -1]}},
    "scheme": "nonconforming", "solver": {"method": "active_set"}})");
  document["sweep"] = sweep;
  return document;
}

std::vector<Variation> read(const json& sweep) {
  return parse_request(block(sweep).dump()).sweep;
}

/// The problems of the entries, each made of the one before.
std::vector<Problem> posed(const json& sweep) {
  const Request request = parse_request(block(sweep).dump());
  std::vector<Problem> all;
  Problem varied = request.problem;
  for (const Variation& entry : request.sweep) {
    apply(entry, request.problem, varied);
    all.push_back(varied);
  }
  return all;
}

std::vector<Fault> faults_in(const json& sweep) {
  return faults_of([&] { read(sweep); });
}

TEST(ReadSweep, EntriesAreMergePatches) {
  const json entries = json::parse(R"([
    {"title": "wider", "boundary": {"bottom": {"gap": "x"}}}, {"load": null}, {"boundary": {"bottom": {"gap": null}}},
    {"load": {"body": [1, 2]}, "boundary": {"top": {"value": null, "pressure": 7}}}, {}])");
  EXPECT_EQ(read(entries)[0].title, "wider");
  const std::vector<Problem> sweep = posed(entries);
  ASSERT_EQ(sweep.size(), 5u);
  EXPECT_EQ(std::get<Contact>(sweep[0].boundary.at("bottom")).gap({0.5, 0}), 0.5);
  EXPECT_EQ(sweep[0].body(1, {0.5, 0}), -0.5);
  EXPECT_EQ(sweep[1].body.size(), 0);
  EXPECT_EQ(std::get<Contact>(sweep[1].boundary.at("bottom")).gap({0.5, 0}), 0.1);
  EXPECT_EQ(std::get<Contact>(sweep[2].boundary.at("bottom")).gap({0.5, 0}), 0);
  EXPECT_EQ(sweep[3].body(1, {0.5, 0}), 2);
  EXPECT_EQ(std::get<Pressure>(sweep[3].boundary.at("top")).value({0, 0}), 7);
  EXPECT_EQ(std::get<Traction>(sweep[4].boundary.at("top")).value(1, {0, 0}), -1);
}

TEST(ReadSweep, KnowsWhatDiffersInGapsAlone) {
  const Request request = parse_request(block(json::parse(R"([
    {}, {"boundary": {"bottom": {"gap": 5}}}, {"load": {"body": [0, 1]}}, {"boundary": {"top": {"value": [0, 1]}}}])"))
                                            .dump());
  EXPECT_EQ(request.sweep[0].load_key, request.problem.load_key);
  EXPECT_EQ(request.sweep[1].load_key, request.problem.load_key);
  EXPECT_NE(request.sweep[2].load_key, request.problem.load_key);
  EXPECT_NE(request.sweep[3].load_key, request.problem.load_key);
  EXPECT_EQ(request.problem.operator_key,
            parse_request(block(json::array({json::object()})).dump()).problem.operator_key);
}

TEST(ReadSweep, TakesOtherMaterials) {
  const auto sweep = read(json::parse(R"([
    {"material": {"young": 4}}, {"material": {"young": 3}}, {"material": {"poisson": "0.3 - 0.1 * x"}},
    {"material": {"young": null, "poisson": null, "tensor": [[4, 1, 0], [1, 4, 0], [0, 0, 1.5]]}},
    {"material": {"plane": "stress"}, "load": {"body": [0, -1]}}, {"material": {"young": 4.0}}])"));
  ASSERT_EQ(sweep.size(), 6u);
  const auto young = [&](std::size_t i) {
    return std::get<YoungPoisson>(*sweep[i].material).young(Point(0, 0));
  };
  EXPECT_EQ(young(0), 4);
  EXPECT_FALSE(sweep[1].material) << "it is the problem's own";
  EXPECT_EQ(young(2), 3);
  EXPECT_NEAR(std::get<YoungPoisson>(*sweep[2].material).poisson(Point(0.5, 0)), 0.25, 1e-15);
  EXPECT_TRUE(std::holds_alternative<HookeTensor>(*sweep[3].material));
  EXPECT_EQ(std::get<YoungPoisson>(*sweep[4].material).plane, Plane::stress);
  EXPECT_EQ(sweep[4].body(1, Point(0, 0)), -1);
  std::set<std::string> keys;
  for (const std::size_t i : {0, 2, 3, 4}) keys.insert(sweep[i].material_key);
  EXPECT_EQ(keys.size(), 4u);
  EXPECT_FALSE(keys.contains(""));
  EXPECT_EQ(operators_of(sweep), 6u);
  EXPECT_EQ(operators_of({sweep[0], sweep[0], sweep[1], sweep[1], sweep[2]}), 3u);
}

TEST(ReadSweep, RefusesEveryBadMaterial) {
  EXPECT_THAT(pointers_of(faults_in(json::parse(R"([
    {"material": {"young": -4}}, {"material": {"yuong": 3}}, {"material": null}, {"material": {"poisson": 0.5}},
    {"material": {"tensor": [[4, 1, 0], [1, 4, 0], [0, 0, 1.5]]}}, {"material": {"stiffness": 1}}])"))),
              ElementsAre("/sweep/0/material/young", "/sweep/1/material/yuong", "/sweep/2/material",
                          "/sweep/3/material/poisson", "/sweep/4/material", "/sweep/5/material/stiffness"));
  // What only its values show.
  const json soft{{"material", {{"young", "x - 1"}}}};
  EXPECT_THAT(pointers_of(faults_in(json::array({json::object(), soft}))),
              ElementsAre(testing::StartsWith("/sweep/1/material")));
}

TEST(ReadSweep, RefusesEveryChangeOfTheOperator) {
  const auto faults = faults_in(json::parse(R"([
    {"mesh": {"divisions": [8, 4]}}, {}, {"boundary": {"bottom": {"type": "fixed"}, "right": {"gap": 1}, "top": null}},
    {"boundary": null, "scheme": "conforming"}, 7])"));
  EXPECT_THAT(pointers_of(faults),
              ElementsAre("/sweep/0/mesh", "/sweep/2/boundary/bottom/type", "/sweep/2/boundary/right",
                          "/sweep/2/boundary/top", "/sweep/3/scheme", "/sweep/3/boundary", "/sweep/4"));
  EXPECT_THAT(faults[0].detail, HasSubstr("one mesh"));
  EXPECT_THAT(faults[0].detail, HasSubstr("title, load, boundary, material"));
  EXPECT_THAT(faults[2].detail, HasSubstr("no condition"));
}

TEST(ReadSweep, RefusesEveryBadValue) {
  EXPECT_THAT(pointers_of(faults_in(json::parse(R"([
    {"boundary": {"bottom": {"gap": "x +"}}}, {"load": {"body": 1}}, {"boundary": {"left": {"value": 1}}},
    {"title": 3}, {"boundary": {"top": {"pressure": 1}}}])"))),
              ElementsAre("/sweep/0/boundary/bottom/gap", "/sweep/1/load/body",
                          "/sweep/2/boundary/left/value", "/sweep/3/title", "/sweep/4/boundary/top/value"));
  const json infinite{{"boundary", {{"bottom", {{"gap", "1 / (x - x)"}}}}}};
  EXPECT_THAT(pointers_of(faults_in(json::array({json::object(), infinite}))),
              ElementsAre("/sweep/1/boundary/bottom/gap"));
}

TEST(ReadSweep, HasAtLeastOneEntryAndNotTooMany) {
  EXPECT_THAT(pointers_of(faults_in(json::array())), ElementsAre("/sweep"));
  EXPECT_THAT(pointers_of(faults_in(json::object())), ElementsAre("/sweep"));
  EXPECT_THAT(pointers_of(faults_in(json(10'001, json::object()))), ElementsAre("/sweep"));
  EXPECT_EQ(read(json(10'000, json::object())).size(), 10'000u);
}

TEST(WriteSweep, HasAnEntryAVariation) {
  Solution solution;
  solution.sweep.resize(3);
  solution.sweep[0].title = "first";
  solution.sweep[0].energy = -2;
  solution.sweep[0].contact = {{"floor", {{0.5, 0}}, {0}, {2.5}, {0.25}, {1}, {false}}};
  solution.sweep[1].error = "it lifts off";
  solution.sweep[2].outcome = Outcome::iteration_limit;
  solution.sweep[2].advice = "raise max_iterations";
  const auto write = [&](const char* fields) {
    return json::parse(text_of([&](DocumentWriter& out) {
             write_result(out, {"", "failed", "{}"}, solution, ResultFields::parse(fields));
           }))
        .at("sweep");
  };
  const json sweep = write("sweep,contact");
  ASSERT_EQ(sweep.size(), 3u);
  EXPECT_EQ(sweep[0]["title"], "first");
  EXPECT_EQ(sweep[0]["status"], "succeeded");
  EXPECT_EQ(sweep[0]["summary"]["energy"], -2);
  EXPECT_EQ(sweep[0]["contact"]["floor"]["pressure"], json({2.5}));
  EXPECT_EQ(sweep[1], json({{"status", "failed"}, {"error", "it lifts off"}}));
  EXPECT_EQ(sweep[2]["status"], "failed");
  EXPECT_EQ(sweep[2]["error"], "raise max_iterations");
  EXPECT_EQ(sweep[2]["summary"]["outcome"], "iteration_limit");
  EXPECT_FALSE(write("sweep")[0].contains("contact"));
}

}  // namespace
}  // namespace signorini::api::sweep_json_test
