#pragma once

#include <string>
#include <vector>

namespace signorini::server {

/// What an example looks like once it is solved, as draw_examples.cpp draws it.
struct ExamplePicture {
  std::string name;        ///< the example's, with the ending `.svg.gz`
  std::string compressed;  ///< an SVG, by gzip
};

/// One for each example.
const std::vector<ExamplePicture>& example_pictures();

}  // namespace signorini::server
