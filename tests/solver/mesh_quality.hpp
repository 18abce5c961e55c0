#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/segments.hpp"

namespace signorini {

inline double longest_edge(const Mesh& mesh) {
  double longest = 0;
  for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e) longest = std::max(longest, mesh.length(e));
  return longest;
}

/// The smallest angle of all triangles, in degrees; negative if a triangle runs clockwise.
inline double smallest_angle(const Mesh& mesh) {
  double smallest = 180;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto corners = mesh.corners(t);
    for (int i = 0; i < 3; ++i) {
      const Vector a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
      const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * 180 / std::numbers::pi;
      smallest = std::min(smallest, angle);
    }
  }
  return smallest;
}

/// The edges with a triangle on one side only that are in no part, and those in a part with two triangles.
inline int misfiled_edges(const Mesh& mesh) {
  std::vector<int> times(mesh.edges.size(), 0);
  for (const BoundaryPart& part : mesh.boundary)
    for (const int edge : part.edges) ++times[edge];
  int misfiled = 0;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    misfiled += times[e] != (mesh.edge_triangles[e][1] < 0 ? 1 : 0);
  return misfiled;
}

inline double length_of(const Mesh& mesh, const BoundaryPart& part) {
  double length = 0;
  for (const int edge : part.edges) length += mesh.length(edge);
  return length;
}

/// The number of edges of a part that have no point in common with the one before.
inline int breaks_of(const Mesh& mesh, const BoundaryPart& part) {
  int breaks = 0;
  for (std::size_t i = 1; i < part.edges.size(); ++i) {
    const auto &a = mesh.edges[part.edges[i - 1]], &b = mesh.edges[part.edges[i]];
    breaks += a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1];
  }
  return breaks;
}

inline std::vector<std::string> names_of(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const BoundaryPart& part : mesh.boundary) names.push_back(part.name);
  return names;
}

inline const BoundaryPart& part_of(const Mesh& mesh, const std::string& name) {
  return *std::ranges::find(mesh.boundary, name, &BoundaryPart::name);
}

}  // namespace signorini
