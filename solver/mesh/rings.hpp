#pragma once

#include "mesh/polygon.hpp"
#include "mesh/unit_frame.hpp"

namespace signorini {

/// The rings of a polygon with their points in one numbering, the outer ring first. The edge from a point to
/// the next one of its ring has the number of the point.
struct Rings {
  explicit Rings(const Polygon& polygon);

  std::vector<Point> points;
  std::vector<int> ring;   ///< of each point; 0 is the outer one
  std::vector<int> begin;  ///< the first point of each ring, and the number of points

  int size() const { return static_cast<int>(begin.size()) - 1; }
  int next(int point) const { return point + 1 < begin[ring[point] + 1] ? point + 1 : begin[ring[point]]; }

  /// The JSON pointer of a ring, and of a point in it.
  std::string pointer_to_ring(int number) const;
  std::string pointer_to(int point) const;

  /// The same rings in the coordinates of the frame.
  Rings within(const UnitFrame& frame) const;

  /// The area inside a ring; negative if the ring runs clockwise.
  double signed_area(int number) const;
};

/// The area of the domain: that inside the outer ring less that of the holes, whichever way they run.
double domain_area(const Rings& rings);

}  // namespace signorini
