#include "api/result/result_document.hpp"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/document/json_writer.hpp"
#include "api/examples.hpp"
#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"
#include "written_by.hpp"

namespace signorini::api::result_document_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// A square of two triangles with one contact edge, filled with numbers that tell where they come from.
Solution small_solution(Scheme scheme) {
  Solution solution;
  solution.scheme = scheme;
  solution.mesh = std::make_shared<const Mesh>(
      make_mesh({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}, {"left", "bottom"},
                {{{3, 0}, 0}, {{0, 1}, 1}, {{1, 2}, 1}, {{2, 3}, 1}}));
  const int corners = scheme == Scheme::conforming ? 3 : 1;
  solution.displacement = Eigen::MatrixXd::Constant(corners, 2, 0.5);
  solution.displacement(0, 1) = 0.1;
  solution.displacement_at_points = Eigen::RowVector4d(1, 2, 3, 4);
  solution.stress_at_centroids = Eigen::Matrix2Xd::Constant(2, 2, -1.5);
  solution.contact = {{"bottom", {{0.5, 0}}, {0.25}, {0}, {0.25}, {1}, {true}}};
  solution.summary.method = "uzawa";
  solution.summary.triangles = 2;
  solution.summary.error_bound = ErrorBound{};
  Iteration first, second;
  first.number = 1;
  first.tension = 1e-3;
  second.number = 2;
  solution.history = {first, second};
  return solution;
}

json document(const Solution& solution, const ResultFields& fields,
              const ResultHead& head = {"abc", "succeeded", R"({ "model":"membrane" })"}) {
  return json::parse(text_of([&](DocumentWriter& out) { write_result(out, head, solution, fields); }));
}

json summary_of(const Summary& summary) {
  return json::parse(text_of([&](DocumentWriter& out) { write_summary(out, summary); }));
}

json columns_of(const std::vector<Iteration>& history) {
  return json::parse(text_of([&](DocumentWriter& out) { write_history(out, history); }));
}

std::vector<std::string> members(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

TEST(WriteResult, HasTheMembersOfTheContract) {
  const json result = document(small_solution(Scheme::nonconforming), {});
  EXPECT_THAT(members(result), UnorderedElementsAre("id", "status", "problem", "summary", "mesh",
                                                    "displacement", "stress", "contact", "history"));
  EXPECT_EQ(result["id"], "abc");
  EXPECT_EQ(result["status"], "succeeded");
  EXPECT_EQ(result["problem"], json::parse(R"({"model": "membrane"})"));
  EXPECT_THAT(
      members(result["summary"]),
      UnorderedElementsAre("outcome", "method", "iterations", "triangles", "unknowns", "energy", "residuals",
                           "contact", "parts", "reused", "error_bound", "timings", "peak_memory_bytes"));
  EXPECT_THAT(members(result["summary"]["unknowns"]),
              UnorderedElementsAre("stress", "displacement", "contact", "rotation"));
  EXPECT_THAT(members(result["summary"]["residuals"]),
              UnorderedElementsAre("equilibrium", "constitutive", "penetration", "tension", "complementarity",
                                   "symmetry"));
  EXPECT_THAT(members(result["summary"]["contact"]), UnorderedElementsAre("force", "max_pressure", "length"));
  EXPECT_THAT(members(result["summary"]["timings"]),
              UnorderedElementsAre("mesh", "assemble", "factorize", "iterate", "certify", "total"));
  EXPECT_EQ(
      result["contact"]["bottom"],
      json::parse(
          R"({"points": [[0.5, 0]], "clearance": [0.25], "pressure": [0], "gap": [0.25], "open": [true]})"));
  EXPECT_EQ(result["mesh"]["triangles"], json::parse("[[0, 1, 2], [0, 2, 3]]"));
  EXPECT_EQ(result["mesh"]["boundary"]["left"], json::parse("[[0, 3]]"));
  EXPECT_EQ(result["stress"],
            json::parse(R"({"space": "RT0", "at_centroids": [[-1.5, -1.5], [-1.5, -1.5]]})"));
}

TEST(WriteResult, GivesTheDisplacementInItsSpace) {
  const json p0 = document(small_solution(Scheme::nonconforming), {})["displacement"];
  EXPECT_EQ(p0, json::parse(R"({"space": "P0", "values": [0.5, 0.1], "at_points": [1, 2, 3, 4]})"));
  const json conforming = document(small_solution(Scheme::conforming), {});
  EXPECT_EQ(conforming["displacement"]["space"], "P1");
  EXPECT_EQ(conforming["displacement"]["values"], json::parse("[[0.5, 0.5, 0.5], [0.1, 0.5, 0.5]]"));
  EXPECT_EQ(conforming["stress"]["space"], "RT1");
}

TEST(WriteResult, GivesTheLevelsOfAnAdaptiveMeshAsColumns) {
  Summary summary;
  EXPECT_FALSE(summary_of(summary).contains("levels"));
  summary.levels = {{1, 32, 96, 0.5, 0.25, 3, 0.125}, {2, 50, 150, 0.25, 0.125, 1, 0.5}};
  EXPECT_EQ(
      summary_of(summary)["levels"],
      json::parse(R"({"level": [1, 2], "triangles": [32, 50], "unknowns": [96, 150], "bound": [0.5, 0.25],
                            "relative": [0.25, 0.125], "iterations": [3, 1], "seconds": [0.125, 0.5]})"));
}

TEST(WriteResult, LeavesOutTheIdThatIsNotThere) {
  EXPECT_FALSE(document(small_solution(Scheme::conforming), {}, {"", "failed", "{}"}).contains("id"));
}

TEST(WriteResult, WritesThePickedMembersOnly) {
  const Solution solution = small_solution(Scheme::conforming);
  const auto picked = [&](std::string_view list) {
    return members(document(solution, ResultFields::parse(list)));
  };
  EXPECT_THAT(picked("summary"), UnorderedElementsAre("id", "status", "summary"));
  EXPECT_THAT(picked("contact,history"),
              UnorderedElementsAre("id", "status", "summary", "contact", "history"));
  EXPECT_THAT(picked("mesh,displacement,stress,problem"),
              UnorderedElementsAre("id", "status", "summary", "mesh", "displacement", "stress", "problem"));
  EXPECT_EQ(picked("").size(), 9u);
}

/// An elastic body with a stress that has round invariants on each triangle.
Solution elastic_solution() {
  Solution solution = small_solution(Scheme::nonconforming);
  solution.components = 2;
  solution.displacement = Eigen::Matrix2d::Constant(0.5);
  solution.displacement_at_points = Eigen::MatrixXd::Zero(2, 4);
  solution.stress_at_centroids.resize(3, 2);
  solution.stress_at_centroids << 3, -5, 0, -5, 2, 0;
  solution.out_of_plane_stress = Eigen::Vector2d(0, -5);
  return solution;
}

TEST(WriteResult, WritesTheInvariantsOfTheStressWhenAskedByName) {
  const Solution solution = elastic_solution();
  const json result = document(solution, ResultFields::parse("principal,von_mises"));
  EXPECT_THAT(members(result), UnorderedElementsAre("id", "status", "summary", "principal", "von_mises"));
  EXPECT_EQ(result["principal"], json::parse("[[4, -1], [-5, -5]]"));
  ASSERT_EQ(result["von_mises"].size(), 2u);
  EXPECT_NEAR(result["von_mises"][0], std::sqrt(21), 1e-14);  // 9 + 3 * 4
  EXPECT_EQ(result["von_mises"][1], 0);                       // σ_zz counts
  const json usual = document(solution, {});
  EXPECT_FALSE(usual.contains("principal"));
  EXPECT_FALSE(usual.contains("von_mises"));
}

TEST(WriteResult, WritesTheSharesOfTheErrorBoundWhenAskedByNameAndIfThereIsOne) {
  Solution solution = elastic_solution();
  const ResultFields fields = ResultFields::parse("error_squares");
  EXPECT_FALSE(document(solution, fields).contains("error_squares"));
  solution.error_squares = Eigen::Vector2d(0.25, 1e-36);
  EXPECT_EQ(document(solution, fields)["error_squares"], json::parse("[0.25, 1e-36]"));
  EXPECT_FALSE(document(solution, {}).contains("error_squares"));
}

TEST(WriteResult, WritesWhatIsSeenOfTheLevelsWhenAskedByNameAndIfThereAreAny) {
  Solution solution = elastic_solution();
  const ResultFields fields = ResultFields::parse("levels");
  EXPECT_FALSE(document(solution, fields).contains("levels"));
  LevelFields level{2, {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}, Eigen::MatrixXd(2, 3), Eigen::VectorXd(1)};
  level.displacement_at_points << 1, 2, 3, 4, 5, 6;
  level.error_squares << 0.25;
  solution.levels = {level};
  EXPECT_EQ(document(solution, fields)["levels"],
            json::parse(R"([{"level": 2, "points": [[0, 0], [1, 0], [0, 1]], "triangles": [[0, 1, 2]],
                             "displacement_at_points": [[1, 4], [2, 5], [3, 6]], "error_squares": [0.25]}])"));
  EXPECT_FALSE(document(solution, {}).contains("levels"));
}

TEST(WriteResult, RefusesTheInvariantsOfAMembraneBeforeItWrites) {
  for (const std::string member : {"principal", "von_mises"}) {
    const auto fields = ResultFields::parse("summary," + member);
    const auto faults = faults_of([&] {
      const Sink none = [](std::string_view) -> bool { throw std::logic_error("it wrote"); };
      PieceWriter pieces(none);
      JsonWriter out(pieces);
      write_result(out, {"", "succeeded", "{}"}, small_solution(Scheme::conforming), fields);
    });
    ASSERT_EQ(pointers_of(faults), std::vector<std::string>{"/fields"});
    EXPECT_THAT(faults[0].detail, HasSubstr("a membrane has no \"" + member + "\""));
    EXPECT_NO_THROW(fields.require_available(2));
  }
  EXPECT_NO_THROW(ResultFields::parse("").require_available(1));
}

TEST(ResultFieldsParse, RefusesUnknownNamesAndSaysWhichItKnows) {
  for (const char* list : {"all", "summary,", ",", "summary,,mesh", "Mesh", "mesh, stress", "energy"}) {
    const auto faults = faults_of([&] { ResultFields::parse(list); });
    ASSERT_EQ(pointers_of(faults), std::vector<std::string>{"/fields"}) << list;
    EXPECT_THAT(faults[0].detail,
                HasSubstr("summary, problem, mesh, displacement, stress, contact, history, "
                          "sweep, study, quantities, principal, von_mises, error_squares, levels"));
  }
}

TEST(WriteResult, SaysWhyItDidNotConverge) {
  Summary summary;
  EXPECT_FALSE(summary_of(summary).contains("advice"));
  summary.outcome = Outcome::iteration_limit;
  summary.advice = "raise \"max_iterations\"";
  const json written = summary_of(summary);
  EXPECT_EQ(written["outcome"], "iteration_limit");
  EXPECT_EQ(written["advice"], summary.advice);
}

TEST(WriteResult, NeverWritesANumberThatIsNotFinite) {
  Solution solution = small_solution(Scheme::conforming);
  solution.displacement(2, 1) = std::nan("");
  EXPECT_THROW(document(solution, {}), std::logic_error);
  EXPECT_NO_THROW(document(solution, ResultFields::parse("summary")));
}

TEST(WriteResult, ComesInPiecesAndStopsWhenNobodyReads) {
  Solution solution = small_solution(Scheme::conforming);
  solution.displacement_at_points = Eigen::MatrixXd::Constant(1, 200'000, 0.1);
  int pieces = 0;
  const auto three_pieces = [&](std::string_view piece) {
    EXPECT_LE(piece.size(), 64u * 1024);
    return ++pieces < 3;
  };
  EXPECT_FALSE(write_document(Format::json, three_pieces, [&](DocumentWriter& out) {
    write_result(out, {"", "succeeded", "{}"}, solution, {});
  }));
  EXPECT_EQ(pieces, 3);
}

TEST(WriteHistory, HasAColumnForEachResidual) {
  const json history = columns_of(small_solution(Scheme::conforming).history);
  EXPECT_THAT(members(history),
              UnorderedElementsAre("iteration", "clearance_change", "equilibrium", "penetration", "tension",
                                   "complementarity", "active", "seconds"));
  EXPECT_EQ(history["iteration"], json::parse("[1, 2]"));
  EXPECT_EQ(history["tension"], json::parse("[0.001, 0]"));
}

TEST(WriteHistory, HasTheCriterionOfThePaperInThePapersForm) {
  Iteration iteration;
  iteration.displacement_change = 0.25;
  EXPECT_EQ(columns_of({iteration})["displacement_change"], json::parse("[0.25]"));
  EXPECT_FALSE(columns_of({}).contains("displacement_change"));
}

TEST(WriteEstimate, HasSizesAndCosts) {
  Estimate estimate;
  estimate.triangles = 288;
  estimate.unknowns.stress = 456;
  estimate.system = 400;
  estimate.memory_bytes = 1234567.8;
  estimate.seconds = 0.25;
  EXPECT_EQ(json::parse(text_of([&](DocumentWriter& out) {
              write_estimates(out, {estimate, {}});
            })),
            json::parse(R"({"valid": true, "triangles": 288,
    "unknowns": {"stress": 456, "displacement": 0, "contact": 0, "rotation": 0}, "system": 400,
    "estimated": {"memory_bytes": 1234568, "seconds": 0.25}})"));
}

TEST(Road, LeadsFromEveryExampleToAResult) {
  for (const Example& example : examples()) {
    SCOPED_TRACE(example.name);
    const Request request = parse_request(example.json);
    const Solution solution = solve(request.problem, request.settings);
    const json result = document(solution, {}, {"", "succeeded", std::string(example.json)});
    EXPECT_EQ(result["summary"]["outcome"], "converged");
    EXPECT_EQ(result["problem"], json::parse(example.json));
    EXPECT_EQ(result["mesh"]["triangles"].size(), result["displacement"]["values"].size());
    EXPECT_EQ(result["mesh"]["points"].size(), result["displacement"]["at_points"].size());
  }
}

}  // namespace
}  // namespace signorini::api::result_document_test
