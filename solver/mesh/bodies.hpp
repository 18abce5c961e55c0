#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

class EdgeTable;

/// The triangles of each body: those that are joined by edges.
std::vector<std::vector<int>> bodies(const Mesh& mesh);

/// The same of triangles that need not form a mesh, by the table of their edges.
std::vector<std::vector<int>> bodies(const std::vector<std::array<int, 3>>& triangles,
                                     const EdgeTable& edges);

/// Of each of so many triangles the number of its body among them.
std::vector<int> body_of_triangles(const std::vector<std::vector<int>>& bodies, std::size_t triangles);

}  // namespace signorini
