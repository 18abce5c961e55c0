#pragma once

#include "mesh/mesh.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// make_mesh() of a mesh that may be large. Throws what the progress throws, if there is one.
Mesh make_mesh(std::vector<Point> points, std::vector<std::array<int, 3>> triangles,
               const std::vector<std::string>& part_names, const std::vector<BoundarySegment>& segments,
               std::vector<Circle> circles, Progress* progress);

}  // namespace signorini
