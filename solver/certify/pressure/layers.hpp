#pragma once

#include <vector>

#include "mesh/mesh.hpp"

namespace signorini {

/// Of every point, the number of triangles that lie between it and the given points, at most `most`.
std::vector<int> layers_around(const Mesh& mesh, const std::vector<int>& points, int most);

}  // namespace signorini
