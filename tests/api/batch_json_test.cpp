#include "api/problem/batch_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/document/json_document.hpp"
#include "api/document/json_slices.hpp"
#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"

namespace signorini::api::batch_json_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

json problem() {
  return json::parse(R"({
    "model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [4, 4]},
    "material": {"stiffness": 1}, "boundary": {"left": {"type": "fixed"}}, "scheme": "conforming"})");
}

/// As the service reads one.
Batch read(const std::string& text, std::vector<std::string>* problems = nullptr) {
  return parse_batch(text, [&](const Batch& batch, std::string_view each, const std::string&) {
    Request request = parse_request(each);
    add_tags(batch.tags, request.tags);
    if (problems != nullptr) problems->emplace_back(each);
  });
}

std::vector<Fault> faults(const json& batch) {
  return faults_of([&] { read(batch.dump()); });
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const MalformedJson& malformed) {
    return malformed.what();
  } catch (const InvalidProblem&) {
    return "faults";
  }
  return "none";
}

TEST(JsonSlices, AreTheTextsOfMembersAndElements) {
  const std::string text =
      "\t{ \"a\\\"}\" : [1,2 , {\"b\": \"]\\\\\"}] ,\n\"c\":-1.5e3,\"d\":\"\", \"\" : null} ";
  const auto members = member_slices(text);
  ASSERT_EQ(members.size(), 4u);
  EXPECT_EQ(members[0], (std::pair<std::string, std::string_view>("a\"}", "[1,2 , {\"b\": \"]\\\\\"}]")));
  EXPECT_EQ(members[1], (std::pair<std::string, std::string_view>("c", "-1.5e3")));
  EXPECT_EQ(members[2], (std::pair<std::string, std::string_view>("d", "\"\"")));
  EXPECT_EQ(members[3], (std::pair<std::string, std::string_view>("", "null")));
  EXPECT_THAT(element_slices(members[0].second), ElementsAre("1", "2", "{\"b\": \"]\\\\\"}"));
  EXPECT_THAT(element_slices("[ ]"), ElementsAre());
  EXPECT_THAT(element_slices("[[],{},true]"), ElementsAre("[]", "{}", "true"));
  EXPECT_THAT(element_slices("7"), ElementsAre());
  EXPECT_TRUE(member_slices("{ }").empty() && member_slices("[1]").empty());
}

TEST(ParseBatch, ReadsEachProblemAsItWasSent) {
  const std::string first = problem().dump(2), second = problem().dump();
  std::vector<std::string> problems;
  const Batch batch = read(
      R"({"title": "both", "tags": ["a", "b"], "problems": [)" + first + " , " + second + "]}", &problems);
  EXPECT_EQ(batch.title, "both");
  EXPECT_THAT(batch.tags, ElementsAre("a", "b"));
  EXPECT_THAT(problems, ElementsAre(first, second));
}

TEST(ParseBatch, TellsAllFaultsWhereTheyStand) {
  json bad = problem();
  bad["load"] = 7;
  bad["tags"] = {"x", "x"};
  EXPECT_THAT(
      pointers_of(faults({{"titel", 1}, {"tags", "t"}, {"problems", {problem(), json::object(), bad}}})),
      ElementsAre("/titel", "/tags", "/problems/1/model", "/problems/1/domain", "/problems/1/mesh",
                  "/problems/1/material", "/problems/1/boundary", "/problems/1/scheme", "/problems/2/tags/1",
                  "/problems/2/load"));
  EXPECT_THAT(pointers_of(faults({{"problems", {nullptr, "x", 3, json::array()}}})),
              ElementsAre("/problems/0", "/problems/1", "/problems/2", "/problems/3"));
  EXPECT_THAT(pointers_of(faults(json::object())), ElementsAre("/problems"));
  EXPECT_THAT(pointers_of(faults({{"problems", json::array()}})), ElementsAre("/problems"));
  EXPECT_THAT(pointers_of(faults({{"problems", problem()}})), ElementsAre("/problems"));
  EXPECT_THAT(pointers_of(faults(json::array())), ElementsAre(""));
  EXPECT_THAT(pointers_of(faults(problem())), testing::Contains("/problems"));
}

TEST(ParseBatch, TakesAThousandProblemsAndLooksAtNoMore) {
  json many = json::array();
  for (int i = 0; i < 1000; ++i) many.push_back(json::object());
  const std::vector<Fault> of_empty = faults({{"problems", many}});
  EXPECT_EQ(of_empty.size(), 101u);
  EXPECT_THAT(of_empty.back().detail, HasSubstr("more faults"));
  many.push_back(json::object());
  EXPECT_THAT(faults({{"problems", many}}).front().detail, HasSubstr("at most 1000 entries; it has 1001"));
}

TEST(ParseBatch, AddsItsTagsToThoseOfEachProblem) {
  std::vector<std::string> tags{"b", "own"};
  add_tags({"a", "b"}, tags);
  EXPECT_THAT(tags, ElementsAre("b", "own", "a"));
  json full = problem();
  for (int i = 0; i < 16; ++i) full["tags"].push_back(std::to_string(i));
  EXPECT_TRUE(faults({{"problems", {full}}, {"tags", {"3"}}}).empty());
  EXPECT_THAT(pointers_of(faults({{"problems", {problem(), full}}, {"tags", {"a"}}})),
              ElementsAre("/problems/1/tags"));
}

TEST(ParseBatch, RefusesWhatIsNoJson) {
  const std::string sound = problem().dump();
  const auto with = [](const std::string& each) { return "{\"problems\": [" + each + "]}"; };
  EXPECT_EQ(refusal(with(sound)), "none");
  EXPECT_THAT(refusal(with(sound) + "x"), HasSubstr("not JSON"));
  EXPECT_THAT(refusal(with(sound + ",")), HasSubstr("not JSON"));
  EXPECT_THAT(refusal(with("{\"a\": \"\xff\"}")), HasSubstr("not JSON"));
  EXPECT_THAT(refusal("{\"problems\": [], \"problems\": []}"), HasSubstr("there twice"));
  EXPECT_THAT(refusal(with(sound + ", {\"mesh\": {\"size\": 1, \"size\": 2}}")),
              HasSubstr("at \"/problems/1\": the member \"size\" at \"/mesh/size\" is there twice"));
  EXPECT_THAT(refusal(with("{\"a\": 1e999}")), HasSubstr("too large"));
  EXPECT_THAT(refusal(with(std::string(100, '[') + std::string(100, ']'))), HasSubstr("nested deeper"));
  EXPECT_EQ(refusal(with(std::string(60, '[') + std::string(60, ']'))), "faults");
  EXPECT_THAT(refusal(with(std::string(2000, '7'))), HasSubstr("digits"));
}

}  // namespace
}  // namespace signorini::api::batch_json_test
