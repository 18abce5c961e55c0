#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

/// The triangles of each body: those that are joined by edges.
std::vector<std::vector<int>> bodies(const Mesh& mesh);

}  // namespace signorini
