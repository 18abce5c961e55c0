#include "api/openapi.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "api/examples.hpp"

namespace signorini::api {
namespace {

using nlohmann::ordered_json;

/// The part that the document begins with.
constexpr std::string_view head = "document";

ordered_json merged_parts() {
  const auto& parts = openapi_parts();
  ordered_json document = ordered_json::parse(std::ranges::find(parts, head, &OpenapiPart::name)->json);
  for (const OpenapiPart& part : parts)
    if (part.name != head) document.update(ordered_json::parse(part.json), true);
  return document;
}

ordered_json body_examples() {
  ordered_json values = ordered_json::object();
  for (const Example& example : examples()) {
    const auto problem = ordered_json::parse(example.json);
    values[std::string(example.name)] = {{"summary", problem.at("title")}, {"value", problem}};
  }
  return values;
}

}  // namespace

const std::string& openapi_document() {
  static const std::string text = [] {
    using namespace nlohmann::literals;
    ordered_json document = merged_parts();
    document["/components/requestBodies/Problem/content/application~1json/examples"_json_pointer] =
        body_examples();
    return document.dump();
  }();
  return text;
}

}  // namespace signorini::api
