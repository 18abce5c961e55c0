#include "mesh/rings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/arc.hpp"
#include "mesh/meeting_boxes.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// Both ends lie so far on one side of the line that nothing between them touches it.
bool lies_beside(const Segment& segment, const Segment& line) {
  const double first = twice_area(line[0], line[1], segment[0]),
               second = twice_area(line[0], line[1], segment[1]),
               reach = touching * (line[1] - line[0]).lpNorm<1>();
  return std::min(first, second) > reach || std::max(first, second) < -reach;
}

/// Whether two edges have more in common than an end.
bool collide(const Rings& unit, int i, int j) {
  const Segment a = unit.edge(i), b = unit.edge(j);
  if (lies_beside(a, b) || lies_beside(b, a)) return false;
  const auto near = [](const Point& x, const Segment& edge) { return distance(x, edge) <= touching; };
  if (unit.next(i) == j) return near(a[0], b) || near(b[1], a);
  if (unit.next(j) == i) return near(b[0], a) || near(a[1], b);
  return near(a[0], b) || near(a[1], b) || near(b[0], a) || near(b[1], a) || cross(a, b);
}

}  // namespace

Rings::Rings(const Polygon& polygon, double longest_chord) : begin{0}, first_vertex_{0} {
  const auto append = [&](const std::vector<Point>& vertices) {
    points.insert(points.end(), vertices.begin(), vertices.end());
    ring.resize(points.size(), size());
    begin.push_back(static_cast<int>(points.size()));
  };
  append(polygon.vertices);
  for (const auto& hole : polygon.holes) append(hole);
  side.resize(points.size());
  for (std::size_t i = 0; i < side.size(); ++i) side[i] = static_cast<int>(i);
  circle.resize(points.size(), -1);
  vertices_ = points;
  first_vertex_ = begin;
  if (polygon.arcs.empty()) return;
  std::vector<std::vector<Point>> on_edges(points.size());
  for (const Arc& given : polygon.arcs) {
    const int from = begin[given.ring] + given.vertex;
    const CircularArc arc(points[from], points[next(from)], given.centre, given.is_long);
    const int parts = arc.parts(longest_chord);
    on_edges[from].clear();
    for (int k = 1; k < parts; ++k) on_edges[from].push_back(arc.at(1. * k / parts));
    circle[from] = static_cast<int>(circles.size());
    circles.push_back(arc.circle());
  }
  *this = with(on_edges);
}

std::string Rings::pointer_to_ring(int number) {
  return number == 0 ? "/domain/vertices" : "/domain/holes/" + std::to_string(number - 1);
}

std::string Rings::pointer_to(int point) const {
  const std::string of_ring = pointer_to_ring(ring[point]);
  const int first = first_vertex_[ring[point]], vertices = first_vertex_[ring[point] + 1] - first;
  // What has one vertex only may have been given as a circle.
  return vertices == 1 ? of_ring : of_ring + '/' + std::to_string(side[point] - first);
}

std::string Rings::in_words(int edge) const {
  const int from = side[edge], last = first_vertex_[ring[edge] + 1] - 1;
  const int to = from < last ? from + 1 : first_vertex_[ring[edge]];
  if (from == to) return "the circle about " + to_string(circles[circle[edge]].centre);
  return (circle[edge] < 0 ? "the edge from " : "the arc from ") + to_string(vertices_[from]) + " to " +
         to_string(vertices_[to]);
}

Rings Rings::within(const UnitFrame& frame) const {
  Rings rings = *this;
  for (Point& x : rings.points) x = frame.into(x);
  for (Circle& own : rings.circles) own = {frame.scaled(own.centre), own.radius / frame.extent()};
  return rings;
}

Rings Rings::with(const std::vector<std::vector<Point>>& on_edges) const {
  Rings rings = *this;
  rings.points.clear();
  rings.ring.clear();
  rings.begin = {0};
  rings.side.clear();
  rings.circle.clear();
  for (int number = 0; number < size(); ++number) {
    for (int p = begin[number]; p < begin[number + 1]; ++p) {
      rings.points.push_back(points[p]);
      rings.points.insert(rings.points.end(), on_edges[p].begin(), on_edges[p].end());
      rings.ring.resize(rings.points.size(), number);
      rings.side.resize(rings.points.size(), side[p]);
      rings.circle.resize(rings.points.size(), circle[p]);
    }
    rings.begin.push_back(static_cast<int>(rings.points.size()));
  }
  return rings;
}

Point Rings::middle(int edge) const {
  const Point middle = 0.5 * (points[edge] + points[next(edge)]);
  return circle[edge] < 0 ? middle : circles[circle[edge]].nearest(middle);
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

std::vector<std::array<int, 2>> colliding_edges(const Rings& unit, std::size_t most) {
  std::vector<Box> boxes;
  for (int e = 0; e < static_cast<int>(unit.points.size()); ++e)
    boxes.push_back(box_around(unit.edge(e), touching));
  std::vector<std::array<int, 2>> pairs;
  for_each_meeting_pair(boxes, [&](int i, int j) {
    if (collide(unit, i, j)) pairs.push_back({std::min(i, j), std::max(i, j)});
    return pairs.size() < most;
  });
  return pairs;
}

namespace {

/// Of edges that do not cross.
double distance_between(const Segment& a, const Segment& b) {
  return std::min({distance(a[0], b), distance(a[1], b), distance(b[0], a), distance(b[1], a)});
}

/// How far a chord is from the middle of its arc; 0 of a straight edge.
double sagitta(const Rings& rings, int edge) {
  if (rings.circle[edge] < 0) return 0;
  const auto [from, to] = rings.edge(edge);
  return (to - from).squaredNorm() / (8 * rings.circles[rings.circle[edge]].radius);
}

/// Halves chords in rounds as long as some collide with another edge, or lie so close to one that `closeness`
/// times the distance from their arc is more.
Rings with_chords_halved(Rings rings, double closeness, int most_rounds, std::size_t most_points) {
  // Arcs among so many edges that are near each other are not looked at more closely: they cross, or the
  // polygon is refused for them.
  std::size_t may_be_tried = 500'000;
  for (int round = 0; round < most_rounds && !rings.circles.empty() && rings.points.size() < most_points;
       ++round) {
    const Rings unit = rings.within(UnitFrame(rings.points));
    std::vector<double> reach;
    std::vector<Box> boxes;
    for (int e = 0; e < static_cast<int>(unit.points.size()); ++e) {
      reach.push_back(closeness * sagitta(unit, e));
      boxes.push_back(box_around(unit.edge(e), touching + reach.back()));
    }
    std::vector<std::vector<Point>> middles(rings.points.size());
    bool are_halved = false;
    for_each_meeting_pair(boxes, [&](int i, int j) {
      if (rings.circle[i] < 0 && rings.circle[j] < 0) return true;
      if (may_be_tried == 0) return false;
      --may_be_tried;
      const bool are_neighbours = unit.next(i) == j || unit.next(j) == i;
      const double apart = collide(unit, i, j) ? 0
                           : are_neighbours    ? std::numeric_limits<double>::infinity()
                                               : distance_between(unit.edge(i), unit.edge(j));
      for (const int edge : {i, j}) {
        if (rings.circle[edge] < 0 || !middles[edge].empty() || apart > reach[edge]) continue;
        middles[edge] = {rings.middle(edge)};
        are_halved = true;
      }
      return true;
    });
    if (!are_halved || may_be_tried == 0) break;
    rings = rings.with(middles);
  }
  return rings;
}

}  // namespace

Rings resolved_rings(Rings rings) {
  const std::size_t most_points = std::max<std::size_t>(15'000, 2 * rings.points.size());
  // Each round brings a chord four times closer to its arc.
  return with_chords_halved(std::move(rings), 0, 8, most_points);
}

Rings followed_rings(const Polygon& polygon, double longest_chord, std::size_t most_points) {
  return with_chords_halved(Rings(polygon, longest_chord), 2, 24, most_points);
}

}  // namespace signorini
