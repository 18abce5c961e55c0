#pragma once

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "mesh/segments.hpp"

namespace signorini {

/// From the lowest corner on, the same way round: triangles of one shape have their corners in one order, and
/// so one matrix. A little of x decides between two corners at one height; by the golden ratio no simple
/// slope of an edge leaves it to rounding.
inline std::array<int, 3> from_lowest(std::array<int, 3> triangle, const std::vector<Point>& points) {
  const auto height = [&](int corner) {
    return points[corner].y() + std::numbers::phi / 32 * points[corner].x();
  };
  std::rotate(triangle.begin(), std::ranges::min_element(triangle, {}, height), triangle.end());
  return triangle;
}

/// The same counter-clockwise, of a triangle that a client gives either way round.
inline std::array<int, 3> in_order(std::array<int, 3> triangle, const std::vector<Point>& points) {
  if (twice_area(points[triangle[0]], points[triangle[1]], points[triangle[2]]) < 0)
    std::swap(triangle[1], triangle[2]);
  return from_lowest(triangle, points);
}

}  // namespace signorini
