#include "mesh/bodies.hpp"

#include <algorithm>
#include <iterator>

#include "mesh/edge_table.hpp"

namespace signorini {
namespace {

/// `for_each_neighbour(triangle, visit)`
template <typename ForEachNeighbour>
std::vector<std::vector<int>> joined(std::size_t triangles, const ForEachNeighbour& for_each_neighbour) {
  std::vector<std::vector<int>> all;
  std::vector<bool> met(triangles, false);
  for (int first = 0; first < static_cast<int>(triangles); ++first) {
    if (met[first]) continue;
    met[first] = true;
    std::vector<int> body{first};
    for (std::size_t next = 0; next < body.size(); ++next)
      for_each_neighbour(body[next], [&](int neighbour) {
        if (neighbour < 0 || met[neighbour]) return;
        met[neighbour] = true;
        body.push_back(neighbour);
      });
    all.push_back(std::move(body));
  }
  return all;
}

}  // namespace

std::vector<std::vector<int>> bodies(const Mesh& mesh) {
  return joined(mesh.triangles.size(), [&](int triangle, const auto& visit) {
    for (const int edge : mesh.triangle_edges[triangle])
      std::ranges::for_each(mesh.edge_triangles[edge], visit);
  });
}

std::vector<std::vector<int>> bodies(const std::vector<std::array<int, 3>>& triangles,
                                     const EdgeTable& edges) {
  return joined(triangles.size(), [&](int triangle, const auto& visit) {
    for (int i = 0; i < 3; ++i) {
      const auto sides = edges.between({triangles[triangle][i], triangles[triangle][(i + 1) % 3]});
      // Of thousands that have one edge each needs only those next to it in the table.
      const auto own = std::ranges::lower_bound(sides, triangle, {}, &TriangleEdge::triangle);
      const auto next = std::ranges::upper_bound(sides, triangle, {}, &TriangleEdge::triangle);
      if (own != sides.begin()) visit(std::prev(own)->triangle);
      if (next != sides.end()) visit(next->triangle);
    }
  });
}

std::vector<int> body_of_triangles(const std::vector<std::vector<int>>& bodies, std::size_t triangles) {
  std::vector<int> body_of(triangles);
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for (const int t : bodies[body]) body_of[t] = static_cast<int>(body);
  return body_of;
}

}  // namespace signorini
