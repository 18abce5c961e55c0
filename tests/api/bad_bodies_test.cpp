// The table of bodies that the service refuses; tests/server sends the same ones through HTTP.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "api/document/json_document.hpp"
#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"

namespace signorini::api::bad_bodies_test {
namespace {

using testing::UnorderedElementsAreArray;

struct BadBody {
  std::string name;
  int status;
  std::vector<std::string> pointers;
  std::string body;
};

std::vector<BadBody> bad_bodies() {
  std::vector<BadBody> bodies;
  for (const auto& row : nlohmann::json::parse(std::ifstream(BAD_BODIES)))
    bodies.push_back({row.at("name"), row.at("status"), row.at("pointers"), row.at("body")});
  return bodies;
}

TEST(BadBodies, ThereAreManyOfThem) {
  EXPECT_GE(bad_bodies().size(), 60u);
}

TEST(BadBodies, EachIsRefusedWithExactlyItsPointers) {
  for (const auto& [name, status, pointers, body] : bad_bodies()) {
    SCOPED_TRACE(name);
    if (status == 400) {
      EXPECT_THROW(parse_request(body), MalformedJson);
    } else {
      EXPECT_THAT(pointers_of(faults_of([&text = body] { parse_request(text); })),
                  UnorderedElementsAreArray(pointers));
    }
  }
}

TEST(BadBodies, EveryFaultSaysSomethingThatIsUtf8) {
  for (const auto& [name, status, pointers, body] : bad_bodies()) {
    SCOPED_TRACE(name);
    if (status == 400) continue;
    for (const Fault& fault : faults_of([&text = body] { parse_request(text); })) {
      EXPECT_GE(fault.detail.size(), 10u);
      EXPECT_NO_THROW(nlohmann::json(fault.detail).dump());
    }
  }
}

}  // namespace
}  // namespace signorini::api::bad_bodies_test
