#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

/// A named part of the boundary: the numbers of its edges, in order along the part where they form a
/// chain.
struct BoundaryPart {
  std::string name;
  std::vector<int> edges;
};

/// A conforming triangulation with its edges.
///
/// Triangles run counter-clockwise. Local edge e of a triangle lies opposite its vertex e and runs from
/// vertex e+1 to vertex e+2. A global edge runs from its smaller to its larger point number.
struct Mesh {
  std::vector<Point> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<BoundaryPart> boundary;

  std::vector<std::array<int, 2>> edges;           ///< point numbers, ascending
  std::vector<std::array<int, 3>> triangle_edges;  ///< the three edges of each triangle
  std::vector<std::array<int, 2>> edge_triangles;  ///< the triangles on both sides, -1 for the outside

  /// Sentences on what was done to it that its request did not ask for.
  std::vector<std::string> notes;

  double length(int edge) const;
  /// The corners of a triangle, counter-clockwise.
  std::array<Point, 3> corners(int triangle) const;
  Point centroid(int triangle) const;
  /// The number (0, 1, 2) that the edge has in the triangle.
  int local_edge(int triangle, int edge) const;
  /// The unit normal of a boundary edge that points out of the domain.
  Vector outward_normal(int edge) const;
  /// The area of the domain.
  double area() const;
  /// The memory that it takes.
  std::size_t bytes() const;
};

/// Two points that bound an edge of the boundary, for the part of the given index.
struct BoundarySegment {
  std::array<int, 2> points;
  int part;
};

/// Numbers the edges of the triangles (whose orientation is counter-clockwise) and sorts the boundary
/// into its named parts. Every segment must be an edge with a triangle on one side only.
Mesh make_mesh(std::vector<Point> points, std::vector<std::array<int, 3>> triangles,
               const std::vector<std::string>& part_names, const std::vector<BoundarySegment>& segments);

}  // namespace signorini
