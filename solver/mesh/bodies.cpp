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

std::vector<int> body_of_triangles(const Mesh& mesh, const std::vector<std::vector<int>>& bodies) {
  std::vector<int> body_of(mesh.triangles.size());
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for (const int t : bodies[body]) body_of[t] = static_cast<int>(body);
  return body_of;
}

}  // namespace signorini
