#include "running_service.hpp"

#include <fstream>
#include <iterator>
#include <set>

namespace signorini::server::bad_bodies_test {
namespace {

using nlohmann::json;

class BadBodies : public ServiceTest {};

std::string text_of(const json& body) {
  return body.is_string() ? body.get<std::string>() : body.dump();
}

std::set<std::string> pointers(const json& problem) {
  std::set<std::string> found;
  for (const json& error : problem.value("errors", json::array())) found.insert(error.at("pointer"));
  return found;
}

TEST_F(BadBodies, GiveTheirStatusAndPointersAndHarmNobody) {
  std::ifstream file(BAD_BODIES);
  const std::string table(std::istreambuf_iterator<char>(file), {});
  const json entries = json::parse(table);
  EXPECT_GE(entries.size(), 60u);
  for (const json& entry : entries) {
    SCOPED_TRACE(entry.at("name").get<std::string>());
    const auto reply = client_.Post("/v1/solves", text_of(entry.at("body")), "application/json");
    const json problem = expect_problem(reply, entry.at("status"));
    EXPECT_EQ(pointers(problem), entry.value("pointers", std::set<std::string>()));
    ASSERT_EQ(get("/healthz")->status, 200);
  }
}

}  // namespace
}  // namespace signorini::server::bad_bodies_test
