#pragma once

#include <string_view>
#include <vector>

namespace signorini::server {

/// What an example looks like once it is solved, as draw_examples.cpp draws it.
struct ExamplePicture {
  std::string_view name;  ///< the example's, with the ending `.svg`
  std::string_view svg;
};

/// One for each example.
const std::vector<ExamplePicture>& example_pictures();

}  // namespace signorini::server
