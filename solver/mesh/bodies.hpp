#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

/// The triangles of each body: those that are joined by edges.
std::vector<std::vector<int>> bodies(const Mesh& mesh);

/// Of each triangle of the mesh the number of its body among them.
std::vector<int> body_of_triangles(const Mesh& mesh, const std::vector<std::vector<int>>& bodies);

}  // namespace signorini
