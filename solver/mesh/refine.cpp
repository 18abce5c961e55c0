#include "mesh/refine.hpp"

#include "mesh/corner_order.hpp"
#include "mesh/make_mesh.hpp"
#include "mesh/parts.hpp"
#include "mesh/upright.hpp"

namespace signorini {
namespace {

Mesh refine_once(const Mesh& mesh, Progress* progress) {
  const auto number = static_cast<int>(mesh.points.size());
  std::vector<Point> points = mesh.points;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) points.push_back(mesh.middle(edge));

  std::vector<std::array<int, 3>> triangles;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (progress) progress->check_in(t);
    const auto& [a, b, c] = mesh.triangles[t];
    const auto& edges = mesh.triangle_edges[t];
    const int bc = number + edges[0], ca = number + edges[1], ab = number + edges[2];
    for (const std::array<int, 3>& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      triangles.push_back(from_lowest(part, points));
  }

  std::vector<BoundarySegment> segments;
  for (int part = 0; part < static_cast<int>(mesh.boundary.size()); ++part) {
    const auto directed = directed_edges(mesh, mesh.boundary[part]);
    for (std::size_t i = 0; i < directed.size(); ++i) {
      const int edge = mesh.boundary[part].edges[i], middle = number + edge;
      segments.push_back({{directed[i][0], middle}, part, mesh.circle_of(edge)});
      segments.push_back({{middle, directed[i][1]}, part, mesh.circle_of(edge)});
    }
  }
  Mesh refined = make_mesh(std::move(points), std::move(triangles), names(mesh.boundary), segments,
                           mesh.circles, progress);
  require_upright(refined);
  return refined;
}

}  // namespace

Mesh refine(const Mesh& mesh, int times, int max_triangles, Progress* progress) {
  std::size_t triangles = mesh.triangles.size();
  for (int i = 0; i < times; ++i) {
    triangles *= 4;
    if (triangles > static_cast<std::size_t>(max_triangles))
      throw InvalidProblem({{"/mesh/refine", "asks for more than " + std::to_string(max_triangles) +
                                                 " triangles; refine less often, or start from a coarser "
                                                 "mesh"}});
  }
  Mesh refined = mesh;
  for (int i = 0; i < times; ++i) refined = refine_once(refined, progress);
  refined.notes = mesh.notes;
  return refined;
}

}  // namespace signorini
