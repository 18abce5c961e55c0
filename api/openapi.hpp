#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace signorini::api {

/// A part of the OpenAPI document; the files of api/openapi, compiled in.
struct OpenapiPart {
  std::string_view name;  ///< the file's name without `.json`
  std::string_view json;
};

const std::vector<OpenapiPart>& openapi_parts();

/// The OpenAPI document of the service as JSON: all parts in one, and the examples as examples of the body
/// that is posted.
const std::string& openapi_document();

}  // namespace signorini::api
