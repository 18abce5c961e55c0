#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

std::vector<std::string> names(const std::vector<BoundaryPart>& parts);

/// The ends of an edge in the direction in which its first triangle, for the boundary the domain, lies on the
/// left.
std::array<int, 2> domain_on_the_left(const Mesh& mesh, int edge);

/// The ends of the edges of a part, each in the direction in which the part runs; an edge without a
/// neighbour in the part has the domain on its left.
std::vector<std::array<int, 2>> directed_edges(const Mesh& mesh, const BoundaryPart& part);

}  // namespace signorini
