#pragma once

#include <string_view>
#include <vector>

namespace signorini::api {

/// A problem that is ready to be posted; the files of api/examples, compiled in.
struct Example {
  std::string_view name;  ///< the file's name without `.json`
  std::string_view json;
};

/// All examples by name.
const std::vector<Example>& examples();

}  // namespace signorini::api
