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

/// A circle that an arc of the boundary lies on.
struct Circle {
  Point centre{0, 0};
  double radius = 0;

  /// The nearest point on the circle; x itself if it lies there but for rounding.
  Point nearest(const Point& x) const;
};

/// A conforming triangulation with its edges.
///
/// An edge of the boundary may be a chord of an arc. The triangles know only the chord; the mesh keeps the
/// circle, so that what is asked of the boundary can be asked of the arc.
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

  std::vector<Circle> circles;    ///< of the arcs
  std::vector<int> edge_circles;  ///< the circle of each edge, -1 where it is straight; empty without arcs

  /// Sentences on what was done to it that its request did not ask for.
  std::vector<std::string> notes;

  double length(int edge) const;
  /// The corners of a triangle, counter-clockwise.
  std::array<Point, 3> corners(int triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {points[a], points[b], points[c]};
  }
  Point centroid(int triangle) const;
  /// The number (0, 1, 2) that the edge has in the triangle.
  int local_edge(int triangle, int edge) const;
  /// The unit normal of a boundary edge that points out of the domain.
  Vector outward_normal(int edge) const;
  /// The angle by which the rounding of its points may turn the normal of an edge.
  double rounding_of_normal(int edge) const;
  /// The number of the circle of whose arc a boundary edge is a chord, or -1.
  int circle_of(int edge) const { return edge_circles.empty() ? -1 : edge_circles[edge]; }
  /// The middle of an edge; of an arc if the edge is its chord.
  Point middle(int edge) const;

  /// A point of the boundary and the unit normal there that points out of the domain.
  struct BoundaryPoint {
    Point x;
    Vector normal;
  };
  /// Where the data of a boundary edge are read at s ∈ [0, 1] from its first to its second point: on the
  /// edge, or if that is the chord of an arc, in the point of the arc nearest to that of the chord, with the
  /// normal of the arc.
  BoundaryPoint on_boundary(int edge, double s) const;

  /// The area of the domain.
  double area() const;
  /// Of the smallest box around it with sides along x and y.
  double diameter() const;
  /// The memory that it takes.
  std::size_t bytes() const;
};

/// Two points that bound an edge of the boundary, for the part of the given index.
struct BoundarySegment {
  std::array<int, 2> points;
  int part;
  int circle = -1;  ///< of whose arc it is a chord
};

/// Numbers the edges of the triangles (whose orientation is counter-clockwise) and sorts the boundary
/// into its named parts. Every segment must be an edge with a triangle on one side only.
Mesh make_mesh(std::vector<Point> points, std::vector<std::array<int, 3>> triangles,
               const std::vector<std::string>& part_names, const std::vector<BoundarySegment>& segments,
               std::vector<Circle> circles = {});

}  // namespace signorini
