#include "mesh/rings.hpp"

#include <cmath>

#include "mesh/segments.hpp"

namespace signorini {

Rings::Rings(const Polygon& polygon) : begin{0} {
  const auto append = [&](const std::vector<Point>& vertices) {
    points.insert(points.end(), vertices.begin(), vertices.end());
    ring.resize(points.size(), size());
    begin.push_back(static_cast<int>(points.size()));
  };
  append(polygon.vertices);
  for (const auto& hole : polygon.holes) append(hole);
}

std::string Rings::pointer_to_ring(int number) const {
  return number == 0 ? "/domain/vertices" : "/domain/holes/" + std::to_string(number - 1);
}

std::string Rings::pointer_to(int point) const {
  return pointer_to_ring(ring[point]) + '/' + std::to_string(point - begin[ring[point]]);
}

Rings Rings::within(const UnitFrame& frame) const {
  Rings rings = *this;
  for (Point& x : rings.points) x = frame.into(x);
  return rings;
}

double Rings::signed_area(int number) const {
  double twice = 0;
  // Around a vertex of the ring itself: the area keeps its digits far from the origin.
  const int first = begin[number];
  for (int p = first; p < begin[number + 1]; ++p)
    twice += twice_area(points[first], points[p], points[next(p)]);
  return 0.5 * twice;
}

double domain_area(const Rings& rings) {
  double area = std::abs(rings.signed_area(0));
  for (int hole = 1; hole < rings.size(); ++hole) area -= std::abs(rings.signed_area(hole));
  return area;
}

}  // namespace signorini
