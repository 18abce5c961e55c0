#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/problem/problem_json.hpp"

namespace signorini::api::operator_key_test {
namespace {

using nlohmann::json;

json block() {
  return json::parse(R"({
    "title": "a block", "model": "elasticity", "domain": {"type": "rectangle", "size": [2, 1]},
    "mesh": {"divisions": [4, 2]}, "material": {"young": 3, "poisson": 0.3}, "load": {"body": [0, "x"]},
    "boundary": {"left": {"type": "roller"}, "bottom": {"type": "contact", "gap": 0.1},
                 "top": {"type": "traction", "value": [0, -1]}, "right": {"type": "fixed", "value": [0, "y"]}},
    "scheme": "conforming", "solver": {"method": "active_set"}})");
}

std::string key_of(const json& document) {
  return parse_request(document.dump()).problem.operator_key;
}

/// The key of the block with one member replaced.
std::string key_with(const char* pointer, const json& value) {
  json document = block();
  document[json::json_pointer(pointer)] = value;
  return key_of(document);
}

TEST(OperatorKey, LeavesOutTitleSolverAndData) {
  const std::string key = key_of(block());
  EXPECT_FALSE(key.empty());
  EXPECT_EQ(key_with("/title", "another"), key);
  EXPECT_EQ(key_with("/solver", {{"method", "uzawa"}}), key);
  EXPECT_EQ(key_with("/load/body/1", 7), key);
  EXPECT_EQ(key_with("/boundary/bottom/gap", "x / 9"), key);
  EXPECT_EQ(key_with("/boundary/right/value/0", 1), key);
  EXPECT_EQ(key_with("/boundary/top/value/0", 1), key);
  EXPECT_EQ(key_with("/boundary/top", {{"type", "traction"}, {"pressure", 2}}), key);
  json bare = block();
  bare.erase("title"), bare.erase("load"), bare.erase("solver"), bare["boundary"]["bottom"].erase("gap");
  EXPECT_EQ(key_of(bare), key);
}

TEST(OperatorKey, TellsOperatorsApart) {
  const std::string key = key_of(block());
  EXPECT_NE(key_with("/domain/size/0", 3), key);
  EXPECT_NE(key_with("/mesh/divisions/0", 5), key);
  EXPECT_NE(key_with("/mesh/pattern", "left"), key);
  EXPECT_NE(key_with("/material/young", "3 + x"), key);
  EXPECT_NE(key_with("/material/poisson", 0.4), key);
  EXPECT_NE(key_with("/boundary/left/type", "contact"), key);
  EXPECT_NE(key_with("/boundary/top/type", "fixed"), key);
  EXPECT_NE(key_with("/boundary/bottom/direction", {1, -2}), key);
  EXPECT_NE(key_with("/scheme", "nonconforming"), key);
}

}  // namespace
}  // namespace signorini::api::operator_key_test
