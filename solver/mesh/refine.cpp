#include "mesh/refine.hpp"

#include "mesh/parts.hpp"

namespace signorini {
namespace {

Mesh refine_once(const Mesh& mesh) {
  const auto number = static_cast<int>(mesh.points.size());
  std::vector<Point> points = mesh.points;
  for (const auto& [a, b] : mesh.edges) points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));

  std::vector<std::array<int, 3>> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto& edges = mesh.triangle_edges[t];
    const int bc = number + edges[0], ca = number + edges[1], ab = number + edges[2];
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }

  std::vector<BoundarySegment> segments;
  for (int part = 0; part < static_cast<int>(mesh.boundary.size()); ++part) {
    const auto directed = directed_edges(mesh, mesh.boundary[part]);
    for (std::size_t i = 0; i < directed.size(); ++i) {
      const int middle = number + mesh.boundary[part].edges[i];
      segments.push_back({{directed[i][0], middle}, part});
      segments.push_back({{middle, directed[i][1]}, part});
    }
  }
  return make_mesh(std::move(points), std::move(triangles), names(mesh.boundary), segments);
}

}  // namespace

Mesh refine(const Mesh& mesh, int times, int max_triangles) {
  std::size_t triangles = mesh.triangles.size();
  for (int i = 0; i < times; ++i) {
    triangles *= 4;
    if (triangles > static_cast<std::size_t>(max_triangles))
      throw InvalidProblem({{"/mesh/refine", "asks for more than " + std::to_string(max_triangles) +
                                                 " triangles; refine less often, or start from a coarser "
                                                 "mesh"}});
  }
  Mesh refined = mesh;
  for (int i = 0; i < times; ++i) refined = refine_once(refined);
  return refined;
}

}  // namespace signorini
