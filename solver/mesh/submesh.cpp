#include "mesh/submesh.hpp"

#include <algorithm>

#include "mesh/parts.hpp"

namespace signorini {

Submesh::Submesh(const Mesh& whole, const std::vector<int>& triangles) {
  std::vector<bool> taken(whole.triangles.size(), false);
  std::vector<int> numbers(whole.points.size(), -1);
  std::vector<Point> points;
  std::vector<std::array<int, 3>> renumbered;
  for (const int t : triangles) {
    taken[t] = true;
    std::array<int, 3> corners = whole.triangles[t];
    for (int& point : corners) {
      if (numbers[point] < 0) {
        numbers[point] = static_cast<int>(points.size());
        points.push_back(whole.points[point]);
      }
      point = numbers[point];
    }
    renumbered.push_back(corners);
  }

  std::vector<std::string> parts;
  std::vector<BoundarySegment> segments;
  const auto add = [&](const std::string& name, const std::vector<int>& edges) {
    if (edges.empty()) return;
    for (const int edge : edges) {
      const auto& [a, b] = whole.edges[edge];
      segments.push_back({{numbers[a], numbers[b]}, static_cast<int>(parts.size()), whole.circle_of(edge)});
    }
    parts.push_back(name);
  };
  for (const BoundaryPart& part : whole.boundary) {
    std::vector<int> own;
    std::ranges::copy_if(part.edges, std::back_inserter(own),
                         [&](int edge) { return taken[whole.edge_triangles[edge][0]]; });
    add(part.name, own);
  }
  for (const int t : triangles)
    for (const int edge : whole.triangle_edges[t]) {
      const auto& [one, other] = whole.edge_triangles[edge];
      if (other >= 0 && taken[one] != taken[other]) cut.push_back(edge);
    }
  add(kCut, cut);
  mesh = make_mesh(std::move(points), std::move(renumbered), parts, segments, whole.circles);
}

}  // namespace signorini
