#include "mesh/bodies.hpp"

namespace signorini {

std::vector<std::vector<int>> bodies(const Mesh& mesh) {
  std::vector<std::vector<int>> all;
  std::vector<bool> met(mesh.triangles.size(), false);
  for (int first = 0; first < static_cast<int>(mesh.triangles.size()); ++first) {
    if (met[first]) continue;
    met[first] = true;
    std::vector<int> body{first};
    for (std::size_t next = 0; next < body.size(); ++next)
      for (const int edge : mesh.triangle_edges[body[next]])
        for (const int neighbour : mesh.edge_triangles[edge]) {
          if (neighbour < 0 || met[neighbour]) continue;
          met[neighbour] = true;
          body.push_back(neighbour);
        }
    all.push_back(std::move(body));
  }
  return all;
}

}  // namespace signorini
