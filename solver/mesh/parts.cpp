#include "mesh/parts.hpp"

namespace signorini {
namespace {

bool has(const std::array<int, 2>& edge, int point) {
  return edge[0] == point || edge[1] == point;
}

}  // namespace

std::array<int, 2> domain_on_the_left(const Mesh& mesh, int edge) {
  const int t = mesh.edge_triangles[edge][0];
  const int e = mesh.local_edge(t, edge);
  return {mesh.triangles[t][(e + 1) % 3], mesh.triangles[t][(e + 2) % 3]};
}

std::vector<std::string> names(const std::vector<BoundaryPart>& parts) {
  std::vector<std::string> all;
  for (const BoundaryPart& part : parts) all.push_back(part.name);
  return all;
}

std::vector<std::array<int, 2>> directed_edges(const Mesh& mesh, const BoundaryPart& part) {
  std::vector<std::array<int, 2>> directed;
  for (std::size_t i = 0; i < part.edges.size(); ++i) {
    std::array<int, 2> ends = domain_on_the_left(mesh, part.edges[i]);
    const bool follows = i > 0 && has(ends, directed[i - 1][1]);
    const bool leads = i + 1 < part.edges.size() && (has(mesh.edges[part.edges[i + 1]], ends[0]) !=
                                                     has(mesh.edges[part.edges[i + 1]], ends[1]));
    const bool backward =
        follows ? ends[0] != directed[i - 1][1] : leads && has(mesh.edges[part.edges[i + 1]], ends[0]);
    if (backward) std::swap(ends[0], ends[1]);
    directed.push_back(ends);
  }
  return directed;
}

}  // namespace signorini
