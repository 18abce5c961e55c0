#include "mesh/mesh_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// Measured on meshes of polygons, as bounds: triangles by the square of the edge that they may have, edges
/// of the boundary by that edge, triangles that an edge of the boundary has to itself if it is shorter, and
/// triangles for every doubling of the distance from points that lie close together but the first.
constexpr double kTrianglesByArea = 5.5, kEdgesByLength = 2, kTrianglesByEdge = 4, kTrianglesByDoubling = 15;

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
  std::int64_t boundary = 0;
  for (const auto& [name, edges] : data.boundary) {
    sizes.parts.push_back({static_cast<std::int64_t>(edges.size()), 0});
    boundary += sizes.parts.back().edges;
  }
  sizes.triangles = static_cast<std::int64_t>(data.triangles.size());
  sizes.points = static_cast<std::int64_t>(data.points.size());
  sizes.edges = (3 * sizes.triangles + boundary) / 2;
  return sizes;
}

/// The edges that one of the boundary is cut into.
double pieces_of(const Segment& edge, double length, double size, const std::vector<LocalSize>& locals) {
  double pieces = length <= size ? 1 : kEdgesByLength * length / size;
  const Box box = box_around(edge, 0);
  for (const LocalSize& local : locals) {
    if (local.size >= std::min(size, length) || !is_within(local.at, wider(box, local.radius)) ||
        distance(local.at, edge) > local.radius)
      continue;
    const double within = std::min(length, 2 * local.radius + local.size);
    pieces += kEdgesByLength * (within / local.size + 2 * std::log2(size / local.size));
  }
  return pieces;
}

/// Counts as numbers, for a tiny size asks for more than integers hold.
std::int64_t counted(double number) {
  return static_cast<std::int64_t>(std::min(number, 1e10));
}

}  // namespace

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
      : rings_(polygon), area_(domain_area(rings_)), parts_(parts_of(polygon)) {
    const Rings unit = rings_.within(UnitFrame(rings_.points));
    in_narrow_places_ =
        narrow_places(unit, near_edges(unit, most_near_pairs), most_in_narrow_places).triangles;
    clusters_ = clusters(rings_.points);
  }

  MeshSizes operator()(const MeshRequest& request) const {
    const double size = std::get<LargestEdge>(request.fineness).length;
    double triangles = in_narrow_places_ + by_area(area_, size), boundary = 0;
    for (const LocalSize& local : request.sizes) triangles += around(local, size);
    for (const Cluster& cluster : clusters_)
      triangles += kTrianglesByDoubling *
                   std::max(0., std::log2(std::min(cluster.distance, size) / cluster.extent) - 1);
    MeshSizes sizes;
    sizes.parts.resize(parts_.names.size());
    for (int e = 0; e < static_cast<int>(rings_.points.size()); ++e) {
      const double length = (rings_.points[rings_.next(e)] - rings_.points[e]).norm();
      const double pieces =
          pieces_of({rings_.points[e], rings_.points[rings_.next(e)]}, length, size, request.sizes);
      if (length < size) triangles += kTrianglesByEdge;
      boundary += pieces;
      MeshSizes::Part& own = sizes.parts[parts_.of_side[rings_.side[e]]];
      own.edges += counted(pieces);
      if (rings_.circle[e] >= 0) own.chords += counted(pieces);
    }
    triangles = std::max(triangles, 2 * boundary);
    sizes.triangles = counted(triangles);
    sizes.edges = counted((3 * triangles + boundary) / 2);
    sizes.points = counted((triangles + boundary) / 2) + 1;  // by Euler's formula
    return sizes;
  }

 private:
  static double by_area(double area, double edge) { return kTrianglesByArea * area / (edge * edge); }

  /// A disc with smaller triangles, and those between them and the others.
  double around(const LocalSize& local, double size) const {
    if (local.size >= size) return 0;
    const double reach = local.radius + 2 * local.size;
    return by_area(std::min(std::numbers::pi * reach * reach, area_), local.size) +
           4 * kTrianglesByEdge * std::log2(size / local.size) * (1 + local.radius / local.size);
  }

  const Rings rings_;
  const double area_;
  const PolygonParts parts_;
  double in_narrow_places_ = 0;
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
