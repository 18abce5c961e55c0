// Titles and tags.

#include "api/problem/problem_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/problem/problem_members.hpp"
#include "faults_of.hpp"

namespace signorini::api::labels_json_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

std::string tagged(const json& tags) {
  json document = json::parse(R"({
    "model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [4, 4]},
    "material": {"stiffness": 1}, "boundary": {"left": {"type": "fixed"}}, "scheme": "conforming"})");
  if (!tags.is_null()) document["tags"] = tags;
  return document.dump();
}

std::vector<Fault> faults(const json& tags) {
  return faults_of([&] { parse_request(tagged(tags)); });
}

TEST(Tags, AreReadAsTheyAre) {
  EXPECT_TRUE(parse_request(tagged(nullptr)).tags.empty());
  EXPECT_TRUE(parse_request(tagged(json::array())).tags.empty());
  std::string longest;
  for (int i = 0; i < 50; ++i) longest += "ü";
  const json tags{"a", "A", " a ", "<b>&\"'</b>", "=1+1", "a,b;c", "\xe2\x80\xae", longest};
  EXPECT_EQ(json(parse_request(tagged(tags)).tags), tags);
  json sixteen = json::array();
  for (int i = 0; i < 16; ++i) sixteen.push_back(std::to_string(i));
  EXPECT_EQ(json(parse_request(tagged(sixteen)).tags), sixteen);
}

TEST(Tags, AreRefusedWithTheirPointers) {
  const std::string line_break = "a\nb", tab = "\t", escape = "\x1b[31m", del = "\x7f",
                    next_line = "\xc2\x85", null("\0", 1);
  const json wrong{"",      std::string(51, 'x'), line_break, tab, escape, del, next_line, null, 7,
                   nullptr, json::array({"a"})};
  const std::vector<Fault> all = faults(wrong);
  ASSERT_EQ(all.size(), wrong.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].where, "/tags/" + std::to_string(i));
  EXPECT_THAT(all[0].detail, HasSubstr("at least one"));
  EXPECT_THAT(all[1].detail, HasSubstr("at most 50 characters; it has 51"));
  EXPECT_THAT(all[2].detail, HasSubstr("control characters"));
  EXPECT_THAT(all[8].detail, HasSubstr("not 7"));
}

TEST(Tags, AreFewAndNoneTwice) {
  EXPECT_THAT(pointers_of(faults({"a", "b", "a"})), ElementsAre("/tags/2"));
  json many = json::array();
  for (int i = 0; i < 17; ++i) many.push_back(std::to_string(i));
  ASSERT_THAT(pointers_of(faults(many)), ElementsAre("/tags"));
  EXPECT_THAT(faults(many).front().detail, HasSubstr("at most 16 entries; it has 17"));
  EXPECT_THAT(pointers_of(faults("a")), ElementsAre("/tags"));
  const std::vector<Fault> long_tag = faults({std::string(900'000, 'x')});
  ASSERT_EQ(long_tag.size(), 1u);
  EXPECT_LT(long_tag.front().detail.size(), 300u);
}

TEST(Tags, ChangeNoOperator) {
  EXPECT_EQ(parse_request(tagged(nullptr)).problem.operator_key,
            parse_request(tagged({"a"})).problem.operator_key);
}

}  // namespace
}  // namespace signorini::api::labels_json_test
