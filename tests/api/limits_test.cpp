#include "api/limits.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/openapi.hpp"

namespace signorini::api::limits_test {
namespace {

using nlohmann::json;

/// A member of the schemas.
json schema(const std::string& pointer) {
  static const json document = json::parse(openapi_document());
  return document.at(json::json_pointer("/components/schemas/" + pointer));
}

/// A number as the document writes it in words.
std::string in_words(std::size_t number) {
  std::string digits = std::to_string(number);
  for (int place = static_cast<int>(digits.size()) - 3; place > 0 && digits.size() > 4; place -= 3)
    digits.insert(static_cast<std::size_t>(place), " ");
  return digits;
}

TEST(Limits, StandInTheOpenapiDocument) {
  const std::vector<std::pair<const char*, std::size_t>> numbers{
      {"Problem/properties/title/maxLength", limits::title},
      {"Variation/properties/title/maxLength", limits::title},
      {"Problem/properties/tags/maxItems", limits::tags},
      {"Tag/maxLength", limits::tag},
      {"Field/maxLength", limits::expression},
      {"Ring/maxItems", limits::vertices},
      {"Polygon/properties/holes/maxItems", limits::holes},
      {"Polygon/properties/sides/maxItems", limits::vertices},
      {"Polygon/properties/sides/items/maxLength", limits::part_name},
      {"GivenMesh/properties/boundary/maxProperties", limits::parts},
      {"Problem/properties/boundary/maxProperties", limits::parts},
      {"MeshRequest/properties/sizes/maxItems", limits::local_sizes},
      {"MeshRequest/properties/divisions/items/maximum", limits::divisions},
      {"MeshRequest/properties/refine/maximum", limits::refinements},
      {"Adaptive/properties/max_triangles/maximum", limits::triangles},
      {"Solver/properties/max_iterations/maximum", limits::iterations},
      {"Problem/properties/sweep/maxItems", limits::sweep_entries},
      {"Batch/properties/problems/maxItems", limits::batch_problems},
      {"Batch/properties/tags/maxItems", limits::tags},
      {"Study/properties/divisions/maxItems", limits::study_meshes},
      {"Study/properties/sizes/maxItems", limits::study_meshes},
      {"Study/properties/refine/maxItems", limits::study_meshes}};
  for (const auto& [pointer, limit] : numbers) EXPECT_EQ(schema(pointer), limit) << pointer;
}

/// What no keyword of a schema can say.
TEST(Limits, OfSumsAreDescribed) {
  const std::vector<std::pair<const char*, std::vector<std::size_t>>> descriptions{
      {"Problem/description",
       {limits::texts, limits::values, limits::values_beside_mesh, limits::members, limits::nesting,
        limits::digits}},
      {"Study/description", {limits::study_local_sizes}},
      {"MeshRequest/properties/sizes/description", {limits::mesh_local_sizes}},
      {"Polygon/description", {limits::vertices, limits::arcs}},
      {"Problem/properties/sweep/description", {limits::sweep_conditions}}};
  for (const auto& [pointer, all] : descriptions)
    for (const std::size_t limit : all)
      EXPECT_NE(schema(pointer).get<std::string>().find(in_words(limit)), std::string::npos)
          << pointer << limit;
}

}  // namespace
}  // namespace signorini::api::limits_test
