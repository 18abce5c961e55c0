#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/arc.hpp"
#include "mesh/fault_list.hpp"
#include "mesh/meeting_boxes.hpp"
#include "mesh/narrow_places.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rings.hpp"

namespace signorini {
namespace {

/// In the unit frame: below this the points of a triangle would not be told apart well.
constexpr double least_size = 1e-8;

/// The rings as they are given.
std::vector<const std::vector<Point>*> given_rings(const Polygon& polygon) {
  std::vector<const std::vector<Point>*> rings{&polygon.vertices};
  for (const auto& hole : polygon.holes) rings.push_back(&hole);
  return rings;
}

std::vector<Fault> faults_of_vertices(const Polygon& polygon) {
  const auto rings = given_rings(polygon);
  std::vector<Fault> faults;
  const auto too_many = [](const char* where, const char* what, int most) -> std::vector<Fault> {
    return {{where, "a polygon may have at most " + std::to_string(most) + what + "; send a mesh instead"}};
  };
  if (polygon.vertex_count() > most_vertices)
    return too_many("/domain/vertices", " vertices with those of its holes", most_vertices);
  if (polygon.holes.size() > most_holes) return too_many("/domain/holes", " holes", most_holes);
  if (polygon.arcs.size() > most_arcs)
    return too_many("/domain/vertices", " arcs with those of its holes", most_arcs);
  FaultList infinite("/domain", "more points that are not finite");
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const bool has_arc =
        std::ranges::any_of(polygon.arcs, [&](const Arc& arc) { return arc.ring == static_cast<int>(r); });
    if (rings[r]->size() < 3 && (rings[r]->empty() || !has_arc))
      faults.push_back(
          {Rings::pointer_to_ring(static_cast<int>(r)), "must have at least three vertices, or an arc"});
    for (std::size_t p = 0; p < rings[r]->size(); ++p)
      if (!(*rings[r])[p].allFinite())
        infinite.add(Rings::pointer_to_ring(static_cast<int>(r)) + '/' + std::to_string(p), "must be finite");
  }
  std::move(infinite).append_to(faults);
  return faults;
}

/// Of points that have no fault.
std::vector<Fault> faults_of_arcs(const Polygon& polygon) {
  const auto rings = given_rings(polygon);
  FaultList faults("/domain", "more arcs that fit no circle");
  for (const Arc& arc : polygon.arcs) {
    const std::vector<Point>& ring = *rings.at(arc.ring);
    const Point &from = ring.at(arc.vertex), &to = ring[(arc.vertex + 1) % ring.size()];
    const std::string reason = why_no_arc(from, to, arc.centre);
    if (reason.empty()) continue;
    // What has one vertex only may have been given as a circle.
    const std::string where = ring.size() == 1 ? "" : '/' + std::to_string(arc.vertex) + "/arc/centre";
    faults.add(Rings::pointer_to_ring(arc.ring) + where, reason);
  }
  std::vector<Fault> all;
  std::move(faults).append_to(all);
  return all;
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
    if (unit.side[first] == unit.side[second]) {
      repeated.add(unit.pointer_to(first),
                   given.in_words(first) +
                       " is so small beside the domain that its points cannot be told "
                       "apart: leave it out, or give it a larger radius");
      return false;
    }
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

std::vector<Fault> crossing_edges(const Rings& given, const Rings& unit) {
  FaultList crossings("/domain", "more edges that cross or touch");
  constexpr std::size_t most = 10;
  std::set<std::array<int, 2>> known;
  for (const auto& [first, second] : colliding_edges(unit, most))
    if (known.insert({unit.side[first], unit.side[second]}).second)
      crossings.add(unit.pointer_to(first), given.in_words(first) + " crosses or touches " +
                                                given.in_words(second) + " that begins at " +
                                                unit.pointer_to(second));
  std::vector<Fault> faults;
  std::move(crossings).append_to(faults);
  return faults;
}

/// Sharper ones, inside or outside the domain, CGAL's mesher does not tell from none: from 1e-8 on, where the
/// cosine is 1, it loses its clusters of edges and the process with them.
constexpr double least_angle = 1e-6;

std::vector<Fault> sharp_angles(const Rings& given, const Rings& unit) {
  FaultList sharp("/domain", "more angles that are so sharp");
  for (int edge = 0; edge < static_cast<int>(unit.points.size()); ++edge) {
    const int tip = unit.next(edge);
    const Vector back = unit.points[edge] - unit.points[tip],
                 forth = unit.points[unit.next(tip)] - unit.points[tip];
    const double sine = (back.x() * forth.y() - back.y() * forth.x()) / (back.norm() * forth.norm());
    if (back.dot(forth) < 0 || std::abs(sine) >= least_angle) continue;
    sharp.add(unit.pointer_to(tip),
              "the edges that meet at " + to_string(given.points[tip]) +
                  " have an angle of less than 1e-6 between them: move their other ends "
                  "apart, or leave this vertex out");
    if (sharp.is_full()) break;
  }
  std::vector<Fault> faults;
  std::move(sharp).append_to(faults);
  return faults;
}

std::vector<Segment> edges_of_ring(const Rings& rings, int ring) {
  std::vector<Segment> edges;
  for (int e = rings.begin[ring]; e < rings.begin[ring + 1]; ++e) edges.push_back(rings.edge(e));
  return edges;
}

/// Holes outside the outer ring or inside another hole; the rings do not touch each other.
std::vector<Fault> misplaced_holes(const Rings& unit) {
  FaultList misplaced("/domain/holes", "more holes that do not lie inside the domain");
  std::vector<std::vector<Segment>> edges;
  std::vector<Box> boxes;
  for (int ring = 0; ring < unit.size(); ++ring) {
    edges.push_back(edges_of_ring(unit, ring));
    boxes.push_back(box_around(edges.back()[0], 0));
    for (const Segment& edge : edges.back())
      boxes.back() = box_around_both(boxes.back(), box_around(edge, 0));
  }
  for (int hole = 1; hole < unit.size(); ++hole) {
    const Point& inside = unit.points[unit.begin[hole]];
    if (winding_number(inside, edges[0]) == 0)
      misplaced.add(unit.pointer_to_ring(hole), "must lie inside the outer ring");
    for (int other = 1; other < unit.size(); ++other)
      if (other != hole && is_within(inside, boxes[other]) && winding_number(inside, edges[other]) != 0)
        misplaced.add(unit.pointer_to_ring(hole),
                      "lies inside " + unit.pointer_to_ring(other) + ", another hole; leave it out");
  }
  std::vector<Fault> faults;
  std::move(misplaced).append_to(faults);
  return faults;
}

std::vector<Fault> faults_of_size(const std::string& where, double size, double extent) {
  if (!(size > 0) || !std::isfinite(size)) return {{where, "must be a positive length"}};
  if (size < least_size * extent) return {{where, "must be at least 1e-8 of the extent of the domain"}};
  return {};
}

std::vector<Fault> intricate_faults(const Rings& given, const Rings& unit, const EdgePairs& near) {
  if (near.size() <= most_near_pairs) return {};
  const auto& [edge, other] = near.back();
  return {{unit.pointer_to(edge),
           "more than " + std::to_string(most_near_pairs) +
               " pairs of edges lie closer to each other than they are long, such as " +
               given.in_words(edge) + " and " + given.in_words(other) +
               ": leave out what the solution does not depend on, or send a mesh instead"}};
}

std::vector<Fault> narrow_faults(const Rings& given, const Rings& unit, const EdgePairs& near) {
  const NarrowPlaces narrow = narrow_places(unit, near, most_in_narrow_places);
  if (narrow.triangles < most_in_narrow_places) return {};
  const auto ends = [&](int e) {
    return to_string(given.points[e]) + " to " + to_string(given.points[given.next(e)]);
  };
  return {{unit.pointer_to(narrow.edge),
           "the domain is so narrow that its mesh would have more than 300,000 triangles whatever its "
           "size, most of them between the edge from " +
               ends(narrow.edge) + " and the edge from " + ends(narrow.opposite) + " that begins at " +
               unit.pointer_to(narrow.opposite) +
               ": move these apart, or join them and leave the narrow place out of the domain"}};
}

}  // namespace

std::vector<Fault> faults_of_shape(const Rings& given) {
  if (const std::string reason = why_no_frame(given.points); !reason.empty())
    return {{"/domain/vertices", reason}};
  const Rings unit = given.within(UnitFrame(given.points));
  const EdgePairs near = near_edges(unit, most_near_pairs + 1);
  // Each check relies on the ones before it.
  std::vector<Fault> faults = repeated_points(given, unit);
  if (faults.empty()) faults = intricate_faults(given, unit, near);
  if (faults.empty()) faults = crossing_edges(given, unit);
  if (faults.empty()) faults = misplaced_holes(unit);
  if (faults.empty()) faults = narrow_faults(given, unit, near);
  if (faults.empty()) faults = sharp_angles(given, unit);
  return faults;
}

std::vector<Fault> validate(const Polygon& polygon) {
  std::vector<Fault> faults = faults_of_vertices(polygon);
  if (faults.empty()) faults = faults_of_arcs(polygon);
  if (faults.empty()) faults = faults_of_shape(resolved_rings(Rings(polygon)));
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
  double perimeter = 0;
  for (int e = 0; e < static_cast<int>(rings.points.size()); ++e)
    perimeter += (rings.points[rings.next(e)] - rings.points[e]).norm();
  if (faults.empty() &&
      (domain_area(rings) > max_triangles * equilateral || perimeter > max_triangles * size))
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
