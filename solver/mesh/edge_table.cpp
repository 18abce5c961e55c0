#include "mesh/edge_table.hpp"

#include <algorithm>

namespace signorini {

EdgeTable::EdgeTable(const std::vector<std::array<int, 3>>& triangles) {
  entries_.reserve(3 * triangles.size());
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int e = 0; e < 3; ++e) {
      const int from = triangles[t][(e + 1) % 3], to = triangles[t][(e + 2) % 3];
      entries_.push_back({{std::min(from, to), std::max(from, to)}, t, from < to});
    }
  std::ranges::sort(entries_, {}, [](const TriangleEdge& e) { return std::pair(e.points, e.triangle); });
}

std::span<const TriangleEdge> EdgeTable::between(std::array<int, 2> points) const {
  std::ranges::sort(points);
  return {std::ranges::lower_bound(entries_, points, {}, &TriangleEdge::points),
          std::ranges::upper_bound(entries_, points, {}, &TriangleEdge::points)};
}

}  // namespace signorini
