#include "mesh/mesh_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/clusters.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/meeting_boxes.hpp"
#include "mesh/narrow_places.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/rings.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// Measured on meshes of polygons, as bounds: triangles by the square of the edge that they may have, pieces
/// of the boundary that are nearly as long as they may be and are cut once more for their neighbours, edges
/// of the boundary for every doubling of their length, and triangles for every doubling of the distance from
/// a point, from points that lie close together but the first.
constexpr double kTrianglesByArea = 5.4, kCutOnceMore = 1.2, kEdgesByDoubling = 2, kTrianglesByDoubling = 15;

/// Triangles that a piece of the boundary has to itself: where they reach across the domain, where they are
/// as large as the others, and where those around them grow to the size of the others.
constexpr double kTrianglesAcross = 1, kTrianglesByEdge = 2, kTrianglesByShortEdge = 4;

MeshSizes sizes_of(const Rectangle& rectangle, const MeshRequest& request) {
  const auto [x, y] = divisions(rectangle, request);
  const std::int64_t squares = std::int64_t{x} * y;
  const bool crossed = request.pattern == Pattern::crossed;
  MeshSizes sizes;
  sizes.triangles = (crossed ? 4 : 2) * squares;
  sizes.edges = (crossed ? 6 : 3) * squares + x + y;
  sizes.points = (std::int64_t{x} + 1) * (y + 1) + (crossed ? squares : 0);
  for (const std::string& side : rectangle_parts())
    sizes.parts.push_back({side == "left" || side == "right" ? y : x, 0});
  return sizes;
}

/// A mesh of whose boundary every edge is in a part.
MeshSizes sizes_of(const MeshData& data) {
  MeshSizes sizes;
  for (const auto& [name, edges] : data.boundary)
    sizes.parts.push_back({static_cast<std::int64_t>(edges.size()), 0});
  sizes.triangles = static_cast<std::int64_t>(data.triangles.size());
  sizes.points = static_cast<std::int64_t>(data.points.size());
  sizes.edges = (3 * sizes.triangles + sizes.edges_of_parts()) / 2;
  return sizes;
}

/// The pieces into which a length is halved until none is longer.
double halvings(double length, double longest) {
  if (length <= longest) return 1;
  int exponent;
  const double half = std::frexp(length / longest, &exponent);
  return std::ldexp(1, half > 0.5 ? exponent : exponent - 1);
}

/// The cotangent of the sharpest angle of a triangle, 20.7 degrees: √7, and a little less for rounding.
constexpr double kSharpestAngle = 2.6457;

/// What becomes of a stretch of the boundary: the mesher halves it until its pieces are no longer than the
/// size, no point across the domain lies in the circle around one, or nearly, and no triangle across is too
/// sharp.
struct Pieces {
  Pieces(const NarrowPlaces::Stretch& stretch, double size) {
    const double empty_circle = stretch.is_mirrored ? stretch.length : 1.9 * stretch.width;
    // What is narrower at one end alone has pieces there that grow from it, not all of its own.
    const double narrow_end = std::max(stretch.least, stretch.width / kGrowing);
    const double longest = std::min({size * (1 + 1e-9), empty_circle, kSharpestAngle * narrow_end});
    const double of_part = halvings(stretch.length, longest);
    count = of_part * stretch.parts;
    if (stretch.least < narrow_end) growing = stretch.parts * std::log2(narrow_end / stretch.least);
    length = stretch.length / of_part;
    const double way_across_squared = length * length + stretch.width * stretch.width;
    constexpr double well_meeting = 0.78 * 2;  // sizes, as measured on bands
    reach_across = way_across_squared <= size * size;
    meet_halfway = way_across_squared <= well_meeting * well_meeting * size * size;
    halve_those_across = std::isfinite(stretch.width) && 0.7 * size < length && length < 0.8 * size;
    constexpr double one_layer = 1.5;  // of triangles
    if (!reach_across && stretch.width <= one_layer * length)
      cuts = 2;  // for the ways across are too long
    else
      count *= cut_for_those_across(length / size, stretch.width / size);
  }

  /// How often a piece is cut for those across, both in sizes: as measured on bands, mostly pieces that are
  /// nearly as long as they may be, and where one row of points between the sides would do but for chance, or
  /// two.
  static double cut_for_those_across(double length, double width) {
    const double lengths = width / length;
    if (length < 0.7) return 1;
    if (width > 1.6 && 1.74 < lengths && lengths <= 2) return 1.8;
    if (width > 2.7 && 2.95 < lengths && lengths < 3.3) return 1.6;
    if (width < 2.3) return 1;
    return length < 0.9 ? 1.25 : 1.5;
  }

  static constexpr double kGrowing = 4;  ///< widths, that the middle of a part speaks for: narrow_places.cpp

  double count, length;
  double growing = 0;  ///< more of them, from the narrow ends
  double cuts = 1;     ///< into so many is each cut whose triangles are counted as if it was not
  bool reach_across;   ///< one triangle does
  bool meet_halfway;   ///< those of both sides, at one row of points between them
  /// The diagonal of their square is hardly too long: those of a whole band may be halved, in chains.
  bool halve_those_across;
  static constexpr double kMoreOfHalved = 0.2;  // as measured on bands
};

/// The part of an edge, as shares of it, within a circle; none where the second is no larger.
std::array<double, 2> shares_within(const Segment& edge, const Point& centre, double radius) {
  const Vector way = edge[1] - edge[0];
  const double length = way.norm(), from_line = std::abs(twice_area(edge[0], edge[1], centre)) / length;
  if (from_line >= radius) return {0, 0};
  const double middle = (centre - edge[0]).dot(way) / length;
  const double half = std::sqrt(radius * radius - from_line * from_line);
  return {std::max(0., (middle - half) / length), std::min(1., (middle + half) / length)};
}

/// The edges that a local size makes of one of the boundary, whose edges would be no longer than `longest`:
/// those of its size, and on both sides of them those that grow.
double edges_around(const LocalSize& local, const Segment& edge, double longest) {
  const auto [begin, end] = shares_within(edge, local.at, local.radius + local.size);
  if (end <= begin) return 0;
  const int sides = (begin > 0 ? 1 : 0) + (end < 1 ? 1 : 0);
  const double growing = sides > 0 ? kEdgesByDoubling * sides * std::log2(longest / local.size) : 0;
  return kCutOnceMore * (end - begin) * halvings((edge[1] - edge[0]).norm(), local.size) + growing;
}

/// Of a triangle whose sides are alike, by their length.
constexpr double kHeight = 0.87;

/// Where two edges meet at a sharp angle. One triangle fills it, as far as half of the shorter one: see
/// narrow_places.hpp.
struct Tip {
  Point at;
  std::array<int, 2> edges;
  double reach, slope;  ///< how far, and by how much the domain grows wider with the distance

  /// Sines of the angle: from here on its triangle is as good as any other, and from here on those beside it.
  static constexpr double kBlunt = 0.62, kSharp = 0.5;
  static constexpr double kTrianglesBehind = 1;  ///< at each edge, the one that fills it

  /// How often each edge is cut behind its triangle, as measured.
  double cuts_behind() const { return slope < 0.38 ? 3 : slope < 0.45 ? 1 : 0; }

  /// The pieces of each edge in there if the triangle may not reach so far.
  double pieces(double size, const std::vector<LocalSize>& locals) const {
    if (slope >= kSharp) return 0;
    double filled = std::min(reach, size);
    for (const LocalSize& local : locals)
      filled = std::min(filled, std::max(local.size, (local.at - at).norm() - local.radius));
    constexpr double by_width = 0.75;  // as measured
    return by_width * std::log(std::min(reach, std::max(filled, size / slope)) / filled) / slope;
  }
};

/// A corner that is not sharp between edges of unlike lengths. Those of the mesh on the longer one grow from
/// the length of the shorter one; their triangles are counted with the cluster of its ends.
struct Step {
  int longer;
  double shorter, length;  ///< of the shorter edge, and of the longer one

  static constexpr double kSharp = -0.5;  ///< cosine of the angle in the domain

  /// As measured; the first is there anyway.
  double edges(double size) const {
    constexpr double by_doubling = 1.2;
    return std::max(0., by_doubling * std::log2(std::min(length, size) / shorter) - 1);
  }
};

/// A short edge between two longer ones that lie opposite each other.
struct Floor {
  double length;
  std::array<int, 2> walls;

  /// How often a wall is cut for it, or as much of it as one triangle may have: as measured, up to where it
  /// is known anyway how long narrow places are cut.
  double cuts(double wall) const {
    const double times = wall / length;
    return times < kLong ? 0 : times < 2 * kLong ? 1 : times < 4 * kLong ? 2 : times < 32 * kLong ? 3 : 0;
  }
  static constexpr double kLong = 2;
};

/// Of so many pairs of discs and edges it is looked how much of a disc lies in the domain: some ten
/// milliseconds.
constexpr std::size_t kMostLookedAt = 100'000;

/// Counts as numbers, for a tiny size asks for more than integers hold.
std::int64_t counted(double number) {
  return static_cast<std::int64_t>(std::min(number, 1e10));
}

}  // namespace

std::int64_t MeshSizes::edges_of_parts() const {
  return std::transform_reduce(parts.begin(), parts.end(), std::int64_t{0}, std::plus{},
                               [](const Part& part) { return part.edges; });
}

MeshSizes sizes_of(const Mesh& mesh) {
  MeshSizes sizes{static_cast<std::int64_t>(mesh.triangles.size()),
                  static_cast<std::int64_t>(mesh.edges.size()),
                  static_cast<std::int64_t>(mesh.points.size()),
                  {}};
  for (const BoundaryPart& part : mesh.boundary)
    sizes.parts.push_back(
        {static_cast<std::int64_t>(part.edges.size()),
         std::ranges::count_if(part.edges, [&](int edge) { return mesh.circle_of(edge) >= 0; })});
  return sizes;
}

/// What its meshes have in common.
class PredictedSizes::OfPolygon {
 public:
  explicit OfPolygon(const Polygon& polygon)
      : rings_(followed_rings(polygon)), area_(domain_area(rings_)), parts_(parts_of(polygon)) {
    const UnitFrame frame(rings_.points);
    const Rings unit = rings_.within(frame);
    stretches_ = narrow_places(unit, near_edges(unit, most_near_pairs), most_in_narrow_places).stretches;
    for (NarrowPlaces::Stretch& stretch : stretches_) {
      stretch.length *= frame.extent();
      stretch.width *= frame.extent();
      stretch.least *= frame.extent();
    }
    for (int ring = 0; ring < rings_.size(); ++ring)
      turns_.push_back(rings_.has_domain_on_the_left(ring) ? 1 : -1);
    find_corners();
    find_floors();
    clusters_ = clusters(rings_);
  }

  MeshSizes operator()(const MeshRequest& request) const {
    const double size = std::get<LargestEdge>(request.fineness).length;
    double triangles = 0, across = 0, boundary = 0, along_it = 0;
    std::vector<double> edges(parts_.names.size()), chords(parts_.names.size());
    const auto add = [&](int edge, double pieces) {
      const int part = parts_.of_side[rings_.side[edge]];
      boundary += pieces;
      edges[part] += pieces;
      if (rings_.circle[edge] >= 0) chords[part] += pieces;
    };
    for (const NarrowPlaces::Stretch& stretch : stretches_) {
      const Pieces pieces(stretch, size);
      add(stretch.edge, pieces.cuts * pieces.count + pieces.growing);
      triangles += kTrianglesByShortEdge * pieces.growing;
      if (pieces.reach_across)
        across += kTrianglesAcross * pieces.count;
      else
        triangles += pieces.count * (2 * pieces.length >= size ? kTrianglesByEdge : kTrianglesByShortEdge);
      const double along = stretch.parts * stretch.length * 0.5,
                   height =
                       pieces.meet_halfway ? stretch.width : std::min(kHeight * pieces.length, stretch.width);
      along_it += along * height;
      if (pieces.halve_those_across)
        triangles += Pieces::kMoreOfHalved * by_area(along * (stretch.width - height), size);
    }
    for (const Tip& tip : tips_)
      for (const int edge : tip.edges) {
        const double pieces = tip.pieces(size, request.sizes) + tip.cuts_behind();
        add(edge, pieces);
        across += kTrianglesAcross * pieces + Tip::kTrianglesBehind;
      }
    for (const Step& step : steps_) add(step.longer, step.edges(size));
    for (const Floor& floor : floors_)
      for (const int wall : floor.walls) {
        const double cuts = floor.cuts(std::min(size, length_of(wall)));
        add(wall, cuts);
        across += kTrianglesAcross * cuts;
      }
    triangles += across + by_area(std::max(0., area_ - along_it), size);
    add_edges_around(request.sizes, size, add);
    const bool are_many = request.sizes.size() * rings_.points.size() > kMostLookedAt;
    for (const LocalSize& local : request.sizes) triangles += around(local, size, are_many);
    for (const Cluster& cluster : clusters_)
      if (const double ratio = std::min(cluster.distance, size) / (2 * cluster.extent); ratio > 1)
        triangles += kTrianglesByDoubling * std::log2(ratio);
    triangles = std::max(triangles, boundary);
    MeshSizes sizes;
    for (std::size_t part = 0; part < edges.size(); ++part)
      sizes.parts.push_back({counted(edges[part]), counted(chords[part])});
    sizes.across = across / triangles;
    sizes.triangles = counted(triangles);
    sizes.edges = counted((3 * triangles + boundary) / 2);
    sizes.points = counted((triangles + boundary) / 2) + 1;  // by Euler's formula
    return sizes;
  }

 private:
  static double by_area(double area, double edge) { return kTrianglesByArea * area / (edge * edge); }

  /// The sharp ones, and those between edges of unlike lengths.
  void find_corners() {
    for (int e = 0; e < static_cast<int>(rings_.points.size()); ++e) {
      const int behind = rings_.next(e);
      const auto [from, at] = rings_.edge(e);
      const Point& to = rings_.points[rings_.next(behind)];
      const double own = (from - at).norm(), other = (to - at).norm();
      const double sine = turns_[rings_.ring[e]] * twice_area(at, to, from) / (own * other),
                   way_back = (from - at).dot(to - at);
      if (sine > 0 && sine < Tip::kBlunt && way_back > 0)
        tips_.push_back({at, {e, behind}, 0.5 * std::min(own, other), sine});
      if (sine <= 0 || way_back <= Step::kSharp * own * other)
        steps_.push_back({own > other ? e : behind, std::min(own, other), std::max(own, other)});
    }
  }

  double length_of(int edge) const {
    const auto [from, to] = rings_.edge(edge);
    return (to - from).norm();
  }

  void find_floors() {
    constexpr double widest = -0.4;  // cosine of the angle with a wall
    for (int wall = 0; wall < static_cast<int>(rings_.points.size()); ++wall) {
      const int floor = rings_.next(wall), opposite = rings_.next(floor);
      const double length = length_of(floor);
      const auto rises = [&](const Segment& one, const Segment& other) {
        const Vector out = one[0] - one[1], along = other[1] - other[0];
        return turns_[rings_.ring[wall]] * twice_area(one[1], other[1], one[0]) > 0 &&
               out.dot(along) > widest * out.norm() * along.norm();
      };
      if (std::min(length_of(wall), length_of(opposite)) > Floor::kLong * length &&
          rises(rings_.edge(wall), rings_.edge(floor)) && rises(rings_.edge(floor), rings_.edge(opposite)))
        floors_.push_back({length, {wall, opposite}});
    }
  }

  /// Calls add(edge, pieces) for each edge that a local size makes of one of the boundary.
  template <typename Add>
  void add_edges_around(std::vector<LocalSize> locals, double size, const Add& add) const {
    if (locals.empty()) return;
    // In a row, so that few are asked whether an edge lies within their reach.
    const auto abscissa = [](const LocalSize& local) { return local.at.x(); };
    std::ranges::sort(locals, {}, abscissa);
    double widest = 0;
    for (const LocalSize& local : locals) widest = std::max(widest, local.radius + local.size);
    for (int e = 0; e < static_cast<int>(rings_.points.size()); ++e) {
      const Segment edge = rings_.edge(e);
      const Box box = box_around(edge, 0);
      const double longest = std::min(size, (edge[1] - edge[0]).norm());
      for (auto local = std::ranges::lower_bound(locals, box.low.x() - widest, {}, abscissa);
           local != locals.end() && local->at.x() <= box.high.x() + widest; ++local)
        if (local->size < longest && is_within(local->at, wider(box, local->radius + local->size)))
          add(e, edges_around(*local, edge, longest));
    }
  }

  /// A disc with smaller triangles, and those between them and the others: for every doubling of their size a
  /// ring, the first as long as the part of the disc's rim in the domain.
  double around(const LocalSize& local, double size, bool are_many) const {
    if (local.size >= size) return 0;
    const double reach = local.radius + local.size, disc = std::numbers::pi * reach * reach;
    const double within = are_many ? std::min(disc, area_) : area_within(local.at, reach);
    const double rim = kTrianglesByDoubling * local.radius / local.size;
    return by_area(within, local.size) + within / disc * rim +
           kTrianglesByDoubling * std::log2(size / local.size);
  }

  /// The area of the domain within a circle: over all edges the triangles to its centre, cut by the circle.
  double area_within(const Point& centre, double radius) const {
    double twice = 0;
    for (int e = 0; e < static_cast<int>(rings_.points.size()); ++e) {
      const Segment edge = rings_.edge(e);
      const auto [begin, end] = shares_within(edge, centre, radius);
      const auto at = [&](double share) -> Point { return edge[0] + share * (edge[1] - edge[0]); };
      const auto sector = [&](const Point& a, const Point& b) {
        return radius * radius * std::atan2(twice_area(centre, a, b), (a - centre).dot(b - centre));
      };
      const Point a = at(begin), b = at(end);
      const double of_edge = end > begin ? sector(edge[0], a) + twice_area(centre, a, b) + sector(b, edge[1])
                                         : sector(edge[0], edge[1]);
      twice += turns_[rings_.ring[e]] * of_edge;
    }
    return std::clamp(twice / 2, 0., area_);
  }

  const Rings rings_;
  const double area_;
  const PolygonParts parts_;
  std::vector<double> turns_;  ///< of the rings: by which the area inside counts for the domain
  std::vector<NarrowPlaces::Stretch> stretches_;
  std::vector<Tip> tips_;
  std::vector<Step> steps_;
  std::vector<Floor> floors_;
  std::vector<Cluster> clusters_;
};

PredictedSizes::PredictedSizes(const Domain& domain) : domain_(domain) {
  if (const auto* polygon = std::get_if<Polygon>(&domain))
    polygon_ = std::make_unique<const OfPolygon>(*polygon);
}

PredictedSizes::~PredictedSizes() = default;

MeshSizes PredictedSizes::operator()(const MeshRequest& request) const {
  if (polygon_) return (*polygon_)(request);
  if (const auto* rectangle = std::get_if<Rectangle>(&domain_)) return sizes_of(*rectangle, request);
  return sizes_of(std::get<MeshData>(domain_));
}

MeshSizes refined(MeshSizes sizes, int times) {
  for (int i = 0; i < times; ++i) {
    sizes.points += sizes.edges;
    sizes.edges = 2 * sizes.edges + 3 * sizes.triangles;
    sizes.triangles *= 4;
    for (MeshSizes::Part& part : sizes.parts) part = {2 * part.edges, 2 * part.chords};
  }
  return sizes;
}

}  // namespace signorini
