#pragma once

#include <array>
#include <vector>

#include "result/solution.hpp"

namespace signorini::api {

/// An edge of the boundary, seen from its triangle.
struct BoundaryLine {
  int part = 0;  ///< number among those of the mesh
  int triangle = 0;
  std::array<int, 2> corners{};  ///< of the triangle, at its ends
  /// At its ends, the same twice for P0; not a number beside the contact.
  std::array<double, 2> clearance{}, pressure{};
};

/// All of them, part by part.
std::vector<BoundaryLine> boundary_lines(const Solution& solution);

}  // namespace signorini::api
