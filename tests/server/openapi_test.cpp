#include "api/openapi.hpp"

#include <algorithm>
#include <set>

#include "running_service.hpp"

namespace signorini::server::openapi_test {
namespace {

using nlohmann::json;

json document() {
  return json::parse(api::openapi_document());
}

/// A method as the document writes it.
std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The media types of every successful reply of the operation.
std::set<std::string> media_types(const json& operation) {
  std::set<std::string> types;
  for (const auto& [status, response] : operation.at("responses").items())
    if (status.starts_with('2') && response.contains("content"))
      for (const auto& [type, content] : response.at("content").items()) types.insert(type);
  return types;
}

class OpenapiTest : public ServiceTest {
 protected:
  const Router& router() { return service_.router(); }
};

TEST_F(OpenapiTest, EveryRouteIsInTheDocumentWithItsMediaTypes) {
  const json paths = document().at("paths");
  for (const Route& route : router().table()) {
    ASSERT_TRUE(paths.contains(route.pattern)) << route.pattern;
    ASSERT_TRUE(paths.at(route.pattern).contains(lower(route.method))) << route.method << route.pattern;
    if (route.media_types.empty()) continue;
    const json& operation = paths.at(route.pattern).at(lower(route.method));
    std::set<std::string> types(route.media_types.begin(), route.media_types.end());
    if (route.page) types.insert("text/html");
    EXPECT_EQ(media_types(operation), types) << route.method << route.pattern;
  }
}

TEST_F(OpenapiTest, EveryOperationOfTheDocumentIsARoute) {
  const auto paths = document().at("paths");
  for (const auto& [path, item] : paths.items()) {
    for (const auto& [method, operation] : item.items()) {
      if (method == "parameters") continue;
      const bool routed =
          std::ranges::any_of(router().table(), [&, &p = path, &m = method](const Route& route) {
            return route.pattern == p && lower(route.method) == m;
          });
      EXPECT_TRUE(routed) << method << path;
    }
  }
}

TEST_F(OpenapiTest, IsServed) {
  const auto reply = get("/openapi.json");
  ASSERT_EQ(reply->status, 200);
  EXPECT_EQ(reply->get_header_value("Content-Type"), "application/json");
  EXPECT_EQ(json::parse(reply->body), document());
}

}  // namespace
}  // namespace signorini::server::openapi_test
