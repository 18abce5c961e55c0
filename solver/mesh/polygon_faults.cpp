#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/fault_list.hpp"
#include "mesh/meeting_boxes.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rings.hpp"

namespace signorini {
namespace {

constexpr int most_vertices = 50'000;

/// In the unit frame, whose rounding of 1e-12 cannot turn apart what is farther apart than this.
constexpr double touching = 1e-9;

/// In the unit frame: below this the points of a triangle would not be told apart well.
constexpr double least_size = 1e-8;

std::vector<Fault> faults_of_vertices(const Rings& rings) {
  std::vector<Fault> faults;
  if (rings.points.size() > most_vertices)
    return {{"/domain/vertices", "a polygon may have at most " + std::to_string(most_vertices) +
                                     " vertices with those of its holes; send a mesh instead"}};
  for (int ring = 0; ring < rings.size(); ++ring)
    if (rings.begin[ring + 1] - rings.begin[ring] < 3)
      faults.push_back({rings.pointer_to_ring(ring), "must have at least three vertices"});
  FaultList infinite("/domain", "more points that are not finite");
  for (int p = 0; p < static_cast<int>(rings.points.size()); ++p)
    if (!rings.points[p].allFinite()) infinite.add(rings.pointer_to(p), "must be finite");
  std::move(infinite).append_to(faults);
  return faults;
}

std::vector<Fault> faults_of_sides(const Polygon& polygon) {
  std::vector<Fault> faults;
  const std::vector<std::string>& sides = polygon.sides;
  if (!sides.empty() && sides.size() != polygon.vertices.size())
    faults.push_back({"/domain/sides", "must have one name for each of the " +
                                           std::to_string(polygon.vertices.size()) + " edges, not " +
                                           std::to_string(sides.size())});
  FaultList names("/domain/sides", "more such names");
  std::set<std::string> of_holes;
  for (std::size_t i = 0; i < polygon.holes.size(); ++i) of_holes.insert("hole" + std::to_string(i));
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::string where = "/domain/sides/" + std::to_string(i);
    if (sides[i].empty()) names.add(where, "must not be empty");
    if (sides[i] == "all") names.add(where, "is reserved for every part not named; choose another name");
    if (of_holes.contains(sides[i])) names.add(where, "is the name of a hole's edges; choose another name");
  }
  std::move(names).append_to(faults);
  return faults;
}

std::vector<Fault> repeated_points(const Rings& given, const Rings& unit) {
  FaultList repeated("/domain/vertices", "more points that repeat another");
  std::vector<Box> boxes;
  for (const Point& x : unit.points) boxes.push_back(box_around({x, x}, touching));
  for_each_meeting_pair(boxes, [&](int i, int j) {
    if ((unit.points[i] - unit.points[j]).norm() > touching) return true;
    const auto [first, second] = std::minmax(i, j);
    const bool closes = unit.next(second) == first;
    repeated.add(unit.pointer_to(second),
                 "repeats " + unit.pointer_to(first) + " at " + to_string(given.points[first]) +
                     (closes ? "; a ring closes by itself, leave its last point out" : ""));
    return !repeated.is_full();
  });
  std::vector<Fault> faults;
  std::move(repeated).append_to(faults);
  return faults;
}

Segment edge_of(const Rings& rings, int edge) {
  return {rings.points[edge], rings.points[rings.next(edge)]};
}

/// Whether two edges have more in common than an end.
bool collide(const Rings& unit, int i, int j) {
  const Segment a = edge_of(unit, i), b = edge_of(unit, j);
  const auto near = [](const Point& x, const Segment& edge) { return distance(x, edge) <= touching; };
  if (unit.next(i) == j) return near(a[0], b) || near(b[1], a);
  if (unit.next(j) == i) return near(b[0], a) || near(a[1], b);
  return near(a[0], b) || near(a[1], b) || near(b[0], a) || near(b[1], a) || cross(a, b);
}

std::vector<Fault> crossing_edges(const Rings& given, const Rings& unit) {
  FaultList crossings("/domain", "more edges that cross or touch");
  std::vector<Box> boxes;
  for (int e = 0; e < static_cast<int>(unit.points.size()); ++e)
    boxes.push_back(box_around(edge_of(unit, e), touching));
  const auto ends = [&](int e) {
    const Segment edge = edge_of(given, e);
    return "from " + to_string(edge[0]) + " to " + to_string(edge[1]);
  };
  for_each_meeting_pair(boxes, [&](int i, int j) {
    if (!collide(unit, i, j)) return true;
    const auto [first, second] = std::minmax(i, j);
    crossings.add(unit.pointer_to(first), "the edge " + ends(first) + " crosses or touches the edge " +
                                              ends(second) + " that begins at " + unit.pointer_to(second));
    return !crossings.is_full();
  });
  std::vector<Fault> faults;
  std::move(crossings).append_to(faults);
  return faults;
}

std::vector<Segment> edges_of_ring(const Rings& rings, int ring) {
  std::vector<Segment> edges;
  for (int e = rings.begin[ring]; e < rings.begin[ring + 1]; ++e) edges.push_back(edge_of(rings, e));
  return edges;
}

/// Holes outside the outer ring or inside another hole; the rings do not touch each other.
std::vector<Fault> misplaced_holes(const Rings& unit) {
  FaultList misplaced("/domain/holes", "more holes that do not lie inside the domain");
  std::vector<std::vector<Segment>> edges;
  for (int ring = 0; ring < unit.size(); ++ring) edges.push_back(edges_of_ring(unit, ring));
  for (int hole = 1; hole < unit.size(); ++hole) {
    const Point& inside = unit.points[unit.begin[hole]];
    if (winding_number(inside, edges[0]) == 0)
      misplaced.add(unit.pointer_to_ring(hole), "must lie inside the outer ring");
    for (int other = 1; other < unit.size(); ++other)
      if (other != hole && winding_number(inside, edges[other]) != 0)
        misplaced.add(unit.pointer_to_ring(hole),
                      "lies inside " + unit.pointer_to_ring(other) + ", another hole; leave it out");
  }
  std::vector<Fault> faults;
  std::move(misplaced).append_to(faults);
  return faults;
}

std::vector<Fault> faults_of_shape(const Rings& given) {
  if (const std::string reason = why_no_frame(given.points); !reason.empty())
    return {{"/domain/vertices", reason}};
  const Rings unit = given.within(UnitFrame(given.points));
  // Each check relies on the ones before it.
  std::vector<Fault> faults = repeated_points(given, unit);
  if (faults.empty()) faults = crossing_edges(given, unit);
  if (faults.empty()) faults = misplaced_holes(unit);
  return faults;
}

std::vector<Fault> faults_of_size(const std::string& where, double size, double extent) {
  if (!(size > 0) || !std::isfinite(size)) return {{where, "must be a positive length"}};
  if (size < least_size * extent) return {{where, "must be at least 1e-8 of the extent of the domain"}};
  return {};
}

}  // namespace

std::vector<Fault> validate(const Polygon& polygon) {
  const Rings rings(polygon);
  std::vector<Fault> faults = faults_of_vertices(rings);
  if (faults.empty()) faults = faults_of_shape(rings);
  const std::vector<Fault> of_sides = faults_of_sides(polygon);
  faults.insert(faults.end(), of_sides.begin(), of_sides.end());
  return faults;
}

std::vector<Fault> validate(const Polygon& polygon, double size, const std::vector<LocalSize>& sizes,
                            int max_triangles) {
  const Rings rings(polygon);
  const double extent = UnitFrame(rings.points).extent();
  std::vector<Fault> faults = faults_of_size("/mesh/size", size, extent);
  // No triangle with edges up to h has a larger area than the equilateral one.
  const double equilateral = std::numbers::sqrt3 / 4 * size * size;
  if (faults.empty() && domain_area(rings) > max_triangles * equilateral)
    faults.push_back({"/mesh/size", "asks for more than " + std::to_string(max_triangles) +
                                        " triangles; give a larger size"});
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::string where = "/mesh/sizes/" + std::to_string(i);
    if (!sizes[i].at.allFinite()) faults.push_back({where + "/at", "must be finite"});
    if (!(sizes[i].radius >= 0) || !std::isfinite(sizes[i].radius))
      faults.push_back({where + "/radius", "must be a length, 0 or more"});
    const std::vector<Fault> of_size = faults_of_size(where + "/size", sizes[i].size, extent);
    faults.insert(faults.end(), of_size.begin(), of_size.end());
  }
  return faults;
}

}  // namespace signorini
