#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

/// The rectangle (origin, origin + size); its boundary parts are `left`, `right`, `bottom`, `top`.
struct Rectangle {
  Point origin{0, 0};
  Vector size{1, 1};
};

/// The edge of a polygon's ring from one vertex to the next as an arc of a circle: of the two arcs the
/// shorter one, or the long one; of half circles the counter-clockwise one, or as the long one the clockwise.
struct Arc {
  int ring = 0;    ///< 0 for the outer ring, i + 1 for hole i
  int vertex = 0;  ///< where it begins
  Point centre{0, 0};
  bool is_long = false;
};

/// A polygon with holes. Rings close by themselves (the last vertex is joined to the first), and run either
/// way round: the domain is what lies inside the outer ring and outside the holes. Edges may be arcs; a ring
/// with one vertex, from which an arc leads back to it, is a circle.
struct Polygon {
  std::vector<Point> vertices;
  std::vector<std::vector<Point>> holes;
  /// The part of each outer edge, edge i from vertex i to vertex i + 1; edges of the same name form one part.
  /// Empty stands for `side0`, `side1`, … The edges of a hole form the part `hole0`, `hole1`, …
  std::vector<std::string> sides;
  std::vector<Arc> arcs{};

  /// Of all rings, which have as many edges.
  std::size_t vertex_count() const {
    std::size_t count = vertices.size();
    for (const auto& hole : holes) count += hole.size();
    return count;
  }
};

/// A mesh as a client gives it: points, triangles of point numbers (from 0), and for each part of the
/// boundary its name and its edges as pairs of point numbers, in any order and direction.
struct MeshData {
  std::vector<Point> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::pair<std::string, std::vector<std::array<int, 2>>>> boundary;
  /// Sentences on what was left out to get it.
  std::vector<std::string> notes = {};
  /// The pointer of the file's text that they were read from, if they were: there stands what is wrong with
  /// them.
  std::string file = {};
};

using Domain = std::variant<Rectangle, Polygon, MeshData>;

/// How the squares of a rectangle are cut into triangles: by the diagonal from bottom left to top right
/// (`right`), by the other one (`left`), by either in turn as on a chessboard (`alternating`), or by both
/// (`crossed`, four triangles a square).
enum class Pattern { right, left, alternating, crossed };

/// The number of squares along x and y.
struct Divisions {
  int x = 0;
  int y = 0;
};

/// The largest edge that the mesh may have (a length).
struct LargestEdge {
  double length = 0;
};

/// Smaller triangles near a place: no edge of a triangle that meets the disc is longer than `size`.
/// Lengths in the units of the domain; radius 0 stands for the triangles around the point.
struct LocalSize {
  Point at{0, 0};
  double radius = 0;
  double size = 0;
};

/// A mesh that refines itself: until the relative error bound is at most `tolerance`, in (0, 1), and as long
/// as it has at most so many triangles. With the name of a quantity the tolerance is for the width of its
/// interval, relative to its estimate.
struct Adaptive {
  double tolerance = 0;
  int max_triangles = 100'000;
  std::string quantity = {};
};

/// The mesh that a domain gets. Divisions and the pattern are for rectangles, local sizes for polygons; a
/// mesh that the client gives needs no fineness.
struct MeshRequest {
  using Fineness = std::variant<Divisions, LargestEdge>;

  MeshRequest() = default;
  MeshRequest(Fineness how_fine, Pattern cut = Pattern::right) : fineness(how_fine), pattern(cut) {}

  Fineness fineness = Divisions{};
  Pattern pattern = Pattern::right;
  std::vector<LocalSize> sizes;
  int refine = 0;                    ///< uniform refinements, each into four times the triangles
  std::optional<Adaptive> adaptive;  ///< the rest of the request is then the mesh to start from
};

}  // namespace signorini
