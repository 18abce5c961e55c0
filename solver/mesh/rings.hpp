#pragma once

#include <limits>

#include "mesh/polygon.hpp"
#include "mesh/segments.hpp"
#include "mesh/unit_frame.hpp"

namespace signorini {

/// The rings of a polygon with their points in one numbering, the outer ring first: its vertices, and between
/// the ends of an arc the ends of the chords that stand for it. The edge from a point to the next one of its
/// ring has the number of the point.
struct Rings {
  /// With chords that are no longer than this. The polygon's arcs have no fault.
  explicit Rings(const Polygon& polygon, double longest_chord = std::numeric_limits<double>::infinity());

  std::vector<Point> points;
  std::vector<int> ring;   ///< of each point; 0 is the outer one
  std::vector<int> begin;  ///< the first point of each ring, and the number of points
  std::vector<int>
      side;  ///< of each edge: on which one of the polygon's edges it lies, all rings in one numbering
  std::vector<int> circle;  ///< of each edge: that of its arc, -1 if it is straight
  std::vector<Circle> circles;

  int size() const { return static_cast<int>(begin.size()) - 1; }
  int next(int point) const { return point + 1 < begin[ring[point] + 1] ? point + 1 : begin[ring[point]]; }
  int before(int point) const { return (point > begin[ring[point]] ? point : begin[ring[point] + 1]) - 1; }
  Segment edge(int from) const { return {points[from], points[next(from)]}; }

  /// The JSON pointer of a ring, and of the vertex at which the side of an edge begins.
  static std::string pointer_to_ring(int number);
  std::string pointer_to(int point) const;

  /// `the edge` or `the arc`, and from where to where the polygon has it.
  std::string in_words(int edge) const;

  /// The same rings in the coordinates of the frame.
  Rings within(const UnitFrame& frame) const;

  /// The same rings with more points on each edge, in its direction.
  Rings with(const std::vector<std::vector<Point>>& on_edges) const;

  /// The middle of an edge; of an arc if the edge is its chord.
  Point middle(int edge) const;

  /// The area inside a ring; negative if the ring runs clockwise.
  double signed_area(int number) const;

  /// Whether the domain lies on the left of the edges of a ring.
  bool has_domain_on_the_left(int number) const { return (signed_area(number) > 0) == (number == 0); }

 private:
  std::vector<Point> vertices_;
  std::vector<int> first_vertex_;  ///< of each ring, and the number of vertices
};

/// The parts of the boundary of a polygon.
struct PolygonParts {
  std::vector<std::string> names;
  std::vector<int> of_side;  ///< of each edge of the polygon, as Rings::side numbers them
};

PolygonParts parts_of(const Polygon& polygon);

/// The area of the domain: that inside the outer ring less that of the holes, whichever way they run.
double domain_area(const Rings& rings);

/// The same rings with so many chords more that no two edges of which one is a chord cross, if the arcs
/// themselves do not.
Rings resolved_rings(Rings rings);

/// Those of a polygon with so many that the domain is about as narrow between them as between the arcs: none
/// is farther from its arc than half of its distance from the nearest other edge, or longer than
/// `longest_chord`. With about `most_points` they are as they are.
Rings followed_rings(const Polygon& polygon, double longest_chord = std::numeric_limits<double>::infinity(),
                     std::size_t most_points = 15'000);

/// Edges of the rings, given in their frame, that have more in common than an end.
std::vector<std::array<int, 2>> colliding_edges(const Rings& unit, std::size_t most);

/// Every fault of the rings as edges between points: repeated points, edges that cross, holes that lie
/// outside.
std::vector<Fault> faults_of_shape(const Rings& rings);

/// In the unit frame, whose rounding of 1e-12 cannot turn apart what is farther apart than this.
constexpr double touching = 1e-9;

}  // namespace signorini
