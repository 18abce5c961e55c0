#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/problem/problem_json.hpp"
#include "api/result/csv.hpp"
#include "api/result/result_document.hpp"
#include "api/result/study_table.hpp"
#include "faults_of.hpp"
#include "written_by.hpp"

namespace signorini::api::study_json_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

json membrane(const json& study) {
  json document = json::parse(R"({
    "title": "a membrane", "model": "membrane", "domain": {"type": "rectangle", "size": [2, 1]},
    "mesh": {"size": 0.5, "pattern": "crossed"}, "material": {"stiffness": 1}, "load": {"body": -1},
    "boundary": {"left": {"type": "fixed"}, "bottom": {"type": "contact", "gap": 0.1}},
    "scheme": "nonconforming", "solver": {"method": "active_set"}})");
  document["study"] = study;
  return document;
}

json block(const json& study) {
  json document = membrane(study);
  document["model"] = "elasticity";
  document["material"] = {{"young", 3}, {"poisson", 0.3}};
  document["load"]["body"] = {0, -1};
  return document;
}

Study read(const json& document) {
  return parse_request(document.dump()).study.value();
}

std::vector<Fault> faults_in(const json& document) {
  return faults_of([&] { parse_request(document.dump()); });
}

TEST(ReadStudy, MeshesAreTheProblemsWithAnotherFineness) {
  const Study study = read(membrane({{"divisions", {4, {8, 2}}}}));
  EXPECT_THAT(study.schemes, ElementsAre(Scheme::nonconforming));
  ASSERT_EQ(study.meshes.size(), 2u);
  EXPECT_EQ(study.meshes[1].name, "/study/divisions/1");
  EXPECT_EQ(study.meshes[1].request.pattern, Pattern::crossed);
  const auto squares = [&](int i) { return std::get<Divisions>(study.meshes[i].request.fineness); };
  EXPECT_EQ(squares(0).x, 4);
  EXPECT_EQ(squares(0).y, 4);
  EXPECT_EQ(squares(1).x, 8);
  EXPECT_EQ(squares(1).y, 2);

  const Study sizes = read(membrane({{"sizes", {0.3, 0.2}}, {"schemes", {"nonconforming", "conforming"}}}));
  EXPECT_THAT(sizes.schemes, ElementsAre(Scheme::nonconforming, Scheme::conforming));
  EXPECT_EQ(std::get<LargestEdge>(sizes.meshes[1].request.fineness).length, 0.2);

  json refined = membrane({{"refine", {0, 2}}});
  refined["mesh"]["refine"] = 1;
  EXPECT_EQ(read(refined).meshes[1].request.refine, 2);
  EXPECT_EQ(std::get<LargestEdge>(read(refined).meshes[1].request.fineness).length, 0.5);

  json adaptive = membrane({{"sizes", {0.3}}});
  adaptive["mesh"]["adaptive"] = {{"tolerance", 0.1}};
  EXPECT_FALSE(read(adaptive).meshes[0].request.adaptive);
  const Study levels = read(membrane({{"adaptive", {{"tolerance", 0.2}}}}));
  EXPECT_EQ(levels.meshes.at(0).request.adaptive->tolerance, 0.2);
}

TEST(ReadStudy, TakesWhatIsKnownOfTheExactSolution) {
  const Exact membranes =
      read(membrane({{"sizes", {0.3}},
                     {"exact", {{"displacement", "x*y"}, {"stress", {"y", "x"}}, {"energy", -2}}}}))
          .exact;
  EXPECT_EQ((*membranes.displacement)(0, {2, 3}), 6);
  EXPECT_EQ(membranes.stress.at(1)({2, 3}), 2);
  EXPECT_EQ(membranes.energy, -2);
  EXPECT_FALSE(read(membrane({{"sizes", {0.3}}})).checks_inf_sup);
  EXPECT_TRUE(read(membrane({{"sizes", {0.3}}, {"check", {"inf_sup"}}})).checks_inf_sup);
  const Exact blocks =
      read(block({{"sizes", {0.3}}, {"exact", {{"displacement", {"x", "y"}}, {"stress", {1, "x", 3}}}}}))
          .exact;
  EXPECT_EQ((*blocks.displacement)(1, {2, 3}), 3);
  EXPECT_EQ(blocks.stress.at(1)({2, 3}), 2);
  EXPECT_FALSE(blocks.energy);
}

TEST(ReadStudy, RefusesEveryFaultWithItsPlace) {
  const auto pointers = [](const json& study) { return pointers_of(faults_in(membrane(study))); };
  EXPECT_THAT(pointers(3), ElementsAre("/study"));
  EXPECT_THAT(pointers(json::object()), ElementsAre("/study"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"refine", {1}}}), ElementsAre("/study"));
  EXPECT_THAT(pointers({{"sizes", json::array()}}), ElementsAre("/study/sizes"));
  EXPECT_THAT(pointers({{"sizes", 0.1}}), ElementsAre("/study/sizes"));
  EXPECT_THAT(pointers({{"sizes", json(65, 0.5)}}), ElementsAre("/study/sizes"));
  EXPECT_THAT(pointers({{"sizes", {0.3, -1, "small", 1e-9}}}),
              ElementsAre("/study/sizes/1", "/study/sizes/2", "/study/sizes/3"));
  EXPECT_THAT(
      pointers({{"divisions", {4, 0, {1, 2, 3}, 1e9, {4, "x"}}}}),
      ElementsAre("/study/divisions/1", "/study/divisions/2", "/study/divisions/3", "/study/divisions/4"));
  EXPECT_THAT(pointers({{"refine", {1, 13}}}), ElementsAre("/study/refine/1"));
  EXPECT_THAT(pointers({{"adaptive", {{"tolerance", 2}, {"max", 3}}}}),
              ElementsAre("/study/adaptive/max", "/study/adaptive/tolerance"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"schemes", {"conforming", "other", "conforming"}}, {"exakt", 1}}),
              ElementsAre("/study/exakt", "/study/schemes/1", "/study/schemes/2"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"schemes", json::array()}}), ElementsAre("/study/schemes"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"check", json::array()}}), ElementsAre("/study/check"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"check", {"inf_sup", "rank", "inf_sup"}}}),
              ElementsAre("/study/check/1", "/study/check/2"));
  EXPECT_THAT(pointers({{"divisions", {4, 1000}}, {"check", {"inf_sup"}}}),
              ElementsAre("/study/divisions/1"));
  EXPECT_THAT(
      pointers({{"sizes", {0.3}},
                {"exact", {{"displacement", {1, 2}}, {"stress", {"x", "z"}}, {"energy", "?"}, {"u", 1}}}}),
      ElementsAre("/study/exact/u", "/study/exact/displacement", "/study/exact/stress/1",
                  "/study/exact/energy"));
  EXPECT_THAT(pointers({{"sizes", {0.3}}, {"exact", {{"displacement", "1 / (x - x)"}}}}),
              ElementsAre("/study/exact/displacement"));
  EXPECT_THAT(pointers_of(faults_in(block({{"sizes", {0.3}}, {"exact", {{"stress", {1, 2}}}}}))),
              ElementsAre("/study/exact/stress"));
}

TEST(ReadStudy, StandsAlone) {
  json document = membrane({{"sizes", {0.3}}});
  document["sweep"] = {{{"title", "again"}}};
  EXPECT_THAT(pointers_of(faults_in(document)), ElementsAre("/study"));
  document = membrane({{"adaptive", {{"tolerance", 0.1}}}});
  document["solver"] = {{"method", "uzawa"}, {"rho", 0.1}, {"augmentation", 1}};
  EXPECT_THAT(pointers_of(faults_in(document)), ElementsAre("/study/adaptive"));
  // What is wrong with the problem is not said again for each mesh.
  document = membrane({{"sizes", {0.3, 0.2}}});
  document["mesh"]["pattern"] = "diagonal";
  EXPECT_THAT(pointers_of(faults_in(document)), ElementsAre("/mesh/pattern"));
}

TEST(ReadStudy, LeavesTheOperatorOfTheProblemAlone) {
  json without = membrane(nullptr);
  without.erase("study");
  EXPECT_EQ(parse_request(membrane({{"sizes", {0.3}}}).dump()).problem.operator_key,
            parse_request(without.dump()).problem.operator_key);
}

StudyRow solved(Scheme scheme, int triangles, double bound) {
  StudyRow row;
  row.scheme = scheme;
  row.size = 0.5;
  row.triangles = triangles;
  row.unknowns = {10, 20, 3, 4};
  row.energy = -2;
  row.error_bound = ErrorBound{};
  row.error_bound->value = bound;
  row.errors.energy_norm = bound / 2;
  row.iterations = 7;
  row.seconds = 0.25;
  return row;
}

std::vector<StudyRow> small_study() {
  StudyRow failed;
  failed.scheme = Scheme::nonconforming;
  failed.error = "/study/sizes/1: it slips, away";
  return {solved(Scheme::conforming, 8, 4), solved(Scheme::conforming, 32, 1),
          solved(Scheme::nonconforming, 8, 8), failed};
}

TEST(WriteStudy, HasARowAMeshAndSchemeAndTheFittedRates) {
  Solution solution;
  solution.study = small_study();
  const auto write = [&](const char* fields) {
    return json::parse(text_of([&](DocumentWriter& out) {
      write_result(out, {"", "failed", "{}"}, solution, ResultFields::parse(fields));
    }));
  };
  EXPECT_FALSE(write("summary").contains("study"));
  const json study = write("study").at("study");
  ASSERT_EQ(study["rows"].size(), 4u);
  EXPECT_EQ(study["rows"][0],
            json::parse(R"({"scheme": "conforming", "size": 0.5, "triangles": 8, "unknowns": 37, "bound": 4.0,
               "energy_norm_error": 2.0, "relative": 0.0, "guaranteed": false, "constitutive": 0.0, "contact": 0.0,
               "oscillation": 0.0, "equilibration": 0.0, "asymmetry": 0.0, "stress_effectivity": 2.0, "energy": -2.0, "iterations": 7,
               "seconds": 0.25})"));
  solution.study[1].inf_sup = 0.25;
  EXPECT_EQ(write("study").at("study")["rows"][1]["inf_sup"], 0.25);
  EXPECT_NEAR(study["rows"][1]["bound_rate"].get<double>(), 2, 1e-14);
  EXPECT_FALSE(study["rows"][2].contains("bound_rate"));
  EXPECT_EQ(study["rows"][3],
            json({{"scheme", "nonconforming"}, {"error", "/study/sizes/1: it slips, away"}}));
  ASSERT_EQ(study["rates"].size(), 2u);
  EXPECT_EQ(study["rates"][0]["scheme"], "conforming");
  EXPECT_NEAR(study["rates"][0]["bound"].get<double>(), 2, 1e-14);
  EXPECT_EQ(study["rates"][1], json({{"scheme", "nonconforming"}}));
}

TEST(StudyCsv, HasTheSameColumns) {
  std::vector<StudyRow> rows = small_study();
  rows.erase(rows.begin());
  EXPECT_EQ(written_by([&](const Sink& sink) { return write_study_csv(rows, sink); }),
            "scheme,size,triangles,unknowns,bound,energy_norm_error,relative,guaranteed,constitutive,contact,"
            "oscillation,equilibration,asymmetry,stress_effectivity,energy,iterations,seconds,error\r\n"
            "conforming,0.5,32,37,1,0.5,0,false,0,0,0,0,0,2,-2,7,0.25,\r\n"
            "nonconforming,0.5,8,37,8,4,0,false,0,0,0,0,0,2,-2,7,0.25,\r\n"
            "nonconforming,,,,,,,,,,,,,,,,,\"/study/sizes/1: it slips, away\"\r\n");
}

TEST(StudyTable, StandsInColumnsThatFitALine) {
  const std::string table =
      written_by([&](const Sink& sink) { return write_study_table(small_study(), sink); });
  EXPECT_THAT(table, HasSubstr("conforming\n\n"
                               "triangles  size  unknowns  bound  bound_rate  energy_norm_error  "
                               "energy_norm_error_rate  relative\n"
                               "        8   0.5        37      4                              2  "
                               "                               0\n"
                               "       32   0.5        37      1           2                0.5  "
                               "                     2         0\n"
                               "   fitted                                  2                   "
                               "                       2          \n\n"));
  EXPECT_THAT(table, HasSubstr("not solved: /study/sizes/1: it slips, away\n"));
  for (std::size_t from = 0, to; (to = table.find('\n', from)) != std::string::npos; from = to + 1)
    EXPECT_LE(to - from, 100u);
}

}  // namespace
}  // namespace signorini::api::study_json_test
