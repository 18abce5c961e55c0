#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "mesh/chains.hpp"
#include "mesh/corner_order.hpp"
#include "mesh/domain_mesher.hpp"
#include "mesh/make_mesh.hpp"
#include "mesh/rings.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// The number of a vertex in the mesh, once it has one.
struct Number {
  int value = -1;
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using NumberedVertex = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel, NumberedVertex>,
                                                 CGAL::Delaunay_mesh_face_base_2<Kernel>>>;
using Face = Triangulation::Face_handle;
using Vertex = Triangulation::Vertex_handle;

Point point_of(Vertex vertex) {
  return {vertex->point().x(), vertex->point().y()};
}

std::array<Point, 3> corners_of(Face face) {
  return {point_of(face->vertex(0)), point_of(face->vertex(1)), point_of(face->vertex(2))};
}

/// The longest edge that a triangle may have, by its place. All lengths in the unit frame.
class SizeField {
 public:
  SizeField(double size, const std::vector<LocalSize>& sizes, const UnitFrame& frame)
      : size_(relaxed(frame.into(size))) {
    for (const LocalSize& local : sizes)
      locals_.push_back(
          {frame.into(local.at), relaxed(frame.into(local.radius)), relaxed(frame.into(local.size))});
    std::ranges::stable_sort(locals_, {}, &LocalSize::size);
  }

  /// The bound for a triangle, or a segment, whose longest edge is given; any bound above that is as good as
  /// the smallest.
  template <typename Shape>
  double bound(const Shape& corners, double longest) const {
    for (const LocalSize& local : locals_) {
      if (local.size >= longest) break;
      if (distance(local.at, corners) <= local.radius) return local.size;
    }
    return size_;
  }

 private:
  /// An edge that is as long as asked but for rounding is not cut in two.
  static double relaxed(double length) { return length * (1 + 1e-9); }

  double size_;
  std::vector<LocalSize> locals_;  // the smallest first
};

/// CGAL's criteria for triangles to be refined, with a size that depends on the place.
class Criteria {
 public:
  explicit Criteria(const SizeField& sizes) : sizes_(&sizes) {}

  struct Quality {
    double excess = 0;        ///< squared longest edge by the squared bound on it
    double sine_squared = 1;  ///< of the smallest angle

    /// Which of two bad triangles is refined first: the one farthest above its size, then the sharpest.
    bool operator<(const Quality& other) const {
      if (excess > 1 || other.excess > 1) return excess > other.excess;
      return sine_squared < other.sine_squared;
    }
  };

  class Is_bad {
   public:
    explicit Is_bad(const SizeField& sizes) : sizes_(&sizes) {}

    CGAL::Mesh_2::Face_badness operator()(const Quality& quality) const {
      if (quality.excess > 1) return CGAL::Mesh_2::IMPERATIVELY_BAD;
      // B = 1/8 (20.7°), for which the refinement is proved to end.
      return quality.sine_squared < 0.125 ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
    }

    CGAL::Mesh_2::Face_badness operator()(Face face, Quality& quality) const {
      quality = quality_of(corners_of(face));
      return (*this)(quality);
    }

   private:
    Quality quality_of(const std::array<Point, 3>& corners) const {
      const auto& [a, b, c] = corners;
      std::array<double, 3> squares{(c - b).squaredNorm(), (a - c).squaredNorm(), (b - a).squaredNorm()};
      std::ranges::sort(squares);
      const double bound = sizes_->bound(corners, std::sqrt(squares[2]));
      const double twice = twice_area(a, b, c);
      return {squares[2] / (bound * bound), twice * twice / (squares[1] * squares[2])};
    }

    const SizeField* sizes_;
  };

  Is_bad is_bad_object() const { return Is_bad(*sizes_); }

 private:
  const SizeField* sizes_;
};

using Marking = CGAL::Delaunay_mesher_2<Triangulation, Criteria>;

/// The order in which points are inserted. Many go along a curve that fills the plane, in rounds of more and
/// more (Amenta, Choi and Rote 2003): along a zigzag each would change as many triangles as there are.
std::vector<std::size_t> order_of(const std::vector<Point>& points) {
  constexpr std::size_t many = 1000;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (points.size() < many) return order;
  std::vector<Kernel::Point_2> known;
  for (const Point& x : points) known.emplace_back(x.x(), x.y());
  using Known = CGAL::Pointer_property_map<Kernel::Point_2>::type;
  CGAL::spatial_sort(order.begin(), order.end(),
                     CGAL::Spatial_sort_traits_adapter_2<Kernel, Known>(CGAL::make_property_map(known)));
  return order;
}

/// The vertices, numbered as the points of the rings, with the edges of the rings as constraints.
/// Points in long rows take up to some tenths of a millisecond each.
std::vector<Vertex> insert_rings(Triangulation& triangulation, const Rings& given, const Rings& unit,
                                 Progress* progress) {
  std::vector<Vertex> vertices(unit.points.size());
  Face near;
  int inserted = 0;
  for (const std::size_t p : order_of(unit.points)) {
    if (progress) progress->check_in(inserted++);
    const Point& x = unit.points[p];
    vertices[p] = triangulation.insert({x.x(), x.y()}, near);
    vertices[p]->info().value = static_cast<int>(p);
    near = vertices[p]->face();
  }
  for (int p = 0; p < static_cast<int>(vertices.size()); ++p) {
    if (progress) progress->check_in(p);
    try {
      triangulation.insert_constraint(vertices[p], vertices[unit.next(p)]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      // As the chords of its first rounds an arc may pass by what it crosses.
      throw InvalidProblem(
          {{unit.pointer_to(p), given.in_words(p) + " crosses or touches another edge, or comes so close to "
                                                    "it that no chords tell them apart"}});
    }
  }
  return vertices;
}

/// The triangle inside a ring on the edge from its first point.
Face face_inside(const Triangulation& triangulation, const std::vector<Vertex>& vertices, const Rings& unit,
                 int ring) {
  const Vertex from = vertices[unit.begin[ring]], to = vertices[unit.begin[ring] + 1];
  Face face;
  int opposite = 0;
  triangulation.is_edge(from, to, face, opposite);
  const bool on_the_left = face->vertex(Triangulation::ccw(opposite)) == from;
  const bool inside_is_left = unit.signed_area(ring) > 0;
  return on_the_left == inside_is_left ? face : face->neighbor(opposite);
}

void mark_domain(Triangulation& triangulation, const std::vector<Vertex>& vertices, const Rings& unit) {
  Marking::mark_convex_hull(triangulation);
  for (int hole = 1; hole < unit.size(); ++hole)
    Marking::propagate_marks(face_inside(triangulation, vertices, unit, hole), false);
}

[[noreturn]] void refuse_size(int max_triangles) {
  throw TooManyTriangles({{"/mesh/size", "the mesh would have more than " + std::to_string(max_triangles) +
                                             " triangles, which the sizes or narrow places of the domain "
                                             "ask for; give larger sizes, or widen the narrow places"}});
}

/// Halves the chords that are longer than their places allow.
Rings halved_to_size(Rings rings, const SizeField& sizes, const UnitFrame& frame, int max_triangles) {
  if (rings.circles.empty()) return rings;
  for (bool is_done = false; !is_done;) {
    const Rings unit = rings.within(frame);
    std::vector<std::vector<Point>> middles(rings.points.size());
    is_done = true;
    for (int e = 0; e < static_cast<int>(rings.points.size()); ++e) {
      const Segment chord{unit.points[e], unit.points[unit.next(e)]};
      const double length = (chord[1] - chord[0]).norm();
      if (rings.circle[e] < 0 || length <= sizes.bound(chord, length)) continue;
      middles[e] = {rings.middle(e)};
      is_done = false;
    }
    rings = rings.with(middles);
    if (rings.points.size() > static_cast<std::size_t>(max_triangles)) refuse_size(max_triangles);
  }
  return rings;
}

int triangles_of_domain(const Triangulation& triangulation) {
  return static_cast<int>(std::ranges::count_if(triangulation.finite_face_handles(),
                                                [](Face face) { return face->is_in_domain(); }));
}

void refine(Triangulation& triangulation, const SizeField& sizes, int max_triangles, Progress* progress) {
  DomainMesher mesher(triangulation, Criteria(sizes));
  // By Euler's formula there are fewer triangles than twice the vertices, and each that comes makes two at
  // most. Counted anew when these might be too many, for on the boundary they make but one.
  auto enough_vertices = static_cast<std::size_t>(max_triangles / 2);
  for (int step = 0; mesher.try_one_step(); ++step) {
    if (progress) progress->check_in(step);
    if (triangulation.number_of_vertices() <= enough_vertices) continue;
    const int triangles = triangles_of_domain(triangulation);
    if (triangles > max_triangles) refuse_size(max_triangles);
    enough_vertices =
        triangulation.number_of_vertices() + static_cast<std::size_t>(max_triangles - triangles) / 2;
  }
}

/// Reads the mesh out of the triangulation of the domain's rings.
///
/// The triangulation cuts edges of the rings at points of its own. Those of a chord go to its arc, unless
/// that would take half its area from a triangle: then the rings must have them first.
class Extraction {
 public:
  Extraction(const Polygon& polygon, const Rings& rings, const UnitFrame& frame,
             const Triangulation& triangulation, Progress* progress)
      : polygon_(polygon), rings_(rings), frame_(frame) {
    points_ = rings.points;
    int seen = 0;
    for (const Face face : triangulation.finite_face_handles()) {
      if (progress) progress->check_in(seen++);
      if (face->is_in_domain()) take(face);
    }
    on_edges_.resize(rings_.points.size());
    const std::vector<Point> as_cut = points_;
    follow_rings();
    keeps_areas_ = rings.circles.empty() || std::ranges::all_of(triangles_, [&](const auto& triangle) {
                     const auto& [a, b, c] = triangle;
                     return twice_area(points_[a], points_[b], points_[c]) >
                            0.5 * twice_area(as_cut[a], as_cut[b], as_cut[c]);
                   });
  }

  /// No triangle has lost much of its area.
  bool keeps_areas() const { return keeps_areas_; }

  /// The rings with the points that their chords were cut at.
  Rings rings_as_cut() const { return rings_.with(on_edges_); }

  Mesh mesh(Progress* progress) && {
    const PolygonParts parts = parts_of(polygon_);
    const auto edges = edges_of(parts);
    std::vector<BoundarySegment> segments;
    for (int part = 0; part < static_cast<int>(edges.size()); ++part)
      for (const auto& edge : in_chains(edges[part])) segments.push_back({edge, part, circles_.at(edge[0])});
    for (std::array<int, 3>& triangle : triangles_) triangle = from_lowest(triangle, points_);
    return make_mesh(std::move(points_), std::move(triangles_), parts.names, segments, rings_.circles,
                     progress);
  }

 private:
  void take(Face face) {
    std::array<int, 3> triangle{};
    for (int i = 0; i < 3; ++i) triangle[i] = number(face->vertex(i));
    triangles_.push_back(triangle);
    // A triangle has the domain on the left of its edges.
    next_.resize(points_.size(), -1);
    for (int i = 0; i < 3; ++i)
      if (face->is_constrained(i)) next_[triangle[(i + 1) % 3]] = triangle[(i + 2) % 3];
  }

  int number(Vertex vertex) {
    int& value = vertex->info().value;
    if (value < 0) {
      value = static_cast<int>(points_.size());
      points_.push_back(frame_.out_of(point_of(vertex)));
    }
    return value;
  }

  bool is_given(int point) const { return point < static_cast<int>(rings_.points.size()); }

  /// Sorts the edges of the boundary by the edge of the polygon on which they lie.
  void follow_rings() {
    pieces_.resize(rings_.points.size());
    circles_.resize(points_.size(), -1);
    for (int ring = 0; ring < rings_.size(); ++ring) {
      int corner = rings_.begin[ring];
      do corner = follow_edge(corner);
      while (corner != rings_.begin[ring]);
    }
  }

  /// From one vertex of the polygon to the next one, in the direction that has the domain on the left.
  int follow_edge(int corner) {
    std::vector<int> along{corner};
    do along.push_back(next_[along.back()]);
    while (!is_given(along.back()));
    const int end = along.back();
    const bool is_forward = rings_.next(corner) == end;
    const int edge = is_forward ? corner : end, circle = rings_.circle[edge];
    for (std::size_t i = 1; i + 1 < along.size(); ++i) {
      put_on_edge(along[i], corner, end);
      if (circle < 0) continue;
      points_[along[i]] = rings_.circles[circle].nearest(points_[along[i]]);
      on_edges_[edge].push_back(points_[along[i]]);
    }
    if (!is_forward) std::ranges::reverse(on_edges_[edge]);
    for (std::size_t i = 1; i < along.size(); ++i) {
      pieces_[edge].push_back({along[i - 1], along[i]});
      circles_[along[i - 1]] = circle;
    }
    return end;
  }

  /// The frame rounds: the point goes to its share of the way between the vertices as they were given.
  void put_on_edge(int point, int from, int to) {
    const Vector whole = points_[to] - points_[from], part = points_[point] - points_[from];
    points_[point] = points_[from] + (part.dot(whole) / whole.squaredNorm()) * whole;
  }

  std::vector<std::vector<std::array<int, 2>>> edges_of(const PolygonParts& parts) const {
    std::vector<std::vector<std::array<int, 2>>> edges(parts.names.size());
    for (int edge = 0; edge < static_cast<int>(pieces_.size()); ++edge) {
      auto& of_part = edges[parts.of_side[rings_.side[edge]]];
      of_part.insert(of_part.end(), pieces_[edge].begin(), pieces_[edge].end());
    }
    return edges;
  }

  const Polygon& polygon_;
  const Rings& rings_;
  const UnitFrame& frame_;
  std::vector<Point> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> next_;                                // along the boundary, of each point on it
  std::vector<std::vector<std::array<int, 2>>> pieces_;  // of each edge of the rings
  std::vector<std::vector<Point>> on_edges_;             // where each chord of the rings was cut
  std::vector<int> circles_;  // of the edge of the boundary that begins in each point
  bool keeps_areas_ = true;
};

void throw_if_any(std::vector<Fault> faults) {
  if (!faults.empty()) throw InvalidProblem(std::move(faults));
}

}  // namespace

std::vector<std::string> part_names(const Polygon& polygon) {
  return parts_of(polygon).names;
}

PolygonParts parts_of(const Polygon& polygon) {
  PolygonParts parts;
  std::map<std::string_view, int> known;
  for (std::size_t i = 0; i < polygon.vertices.size(); ++i) {
    int part = static_cast<int>(parts.names.size());
    if (!polygon.sides.empty()) part = known.insert({polygon.sides[i], part}).first->second;
    if (part == static_cast<int>(parts.names.size()))
      parts.names.push_back(polygon.sides.empty() ? "side" + std::to_string(i) : polygon.sides[i]);
    parts.of_side.push_back(part);
  }
  for (std::size_t i = 0; i < polygon.holes.size(); ++i) {
    parts.of_side.resize(parts.of_side.size() + polygon.holes[i].size(),
                         static_cast<int>(parts.names.size()));
    parts.names.push_back("hole" + std::to_string(i));
  }
  return parts;
}

double area(const Polygon& polygon) {
  return domain_area(Rings(polygon));
}

Mesh polygon_mesh(const Polygon& polygon, double size, const std::vector<LocalSize>& sizes, int max_triangles,
                  Progress* progress) {
  throw_if_any(validate(polygon));
  throw_if_any(validate(polygon, size, sizes, max_triangles));
  Rings rings = resolved_rings(followed_rings(polygon, size));
  const UnitFrame frame(rings.points);
  const SizeField field(size, sizes, frame);
  rings = halved_to_size(std::move(rings), field, frame, max_triangles);
  if (!rings.circles.empty()) throw_if_any(faults_of_shape(rings));

  constexpr int most_rounds = 20;
  for (int round = 0; round < most_rounds; ++round) {
    const Rings unit = rings.within(frame);
    Triangulation triangulation;
    mark_domain(triangulation, insert_rings(triangulation, rings, unit, progress), unit);
    refine(triangulation, field, max_triangles, progress);
    Extraction extraction(polygon, rings, frame, triangulation, progress);
    if (extraction.keeps_areas()) return std::move(extraction).mesh(progress);
    rings = extraction.rings_as_cut();
  }
  throw InvalidProblem(
      std::vector<Fault>{{"/mesh/size",
                          "no mesh of this size follows the arcs of the domain in its narrow "
                          "places; give a smaller size"}});
}

}  // namespace signorini
