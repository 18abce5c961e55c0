#pragma once

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"

namespace signorini {

class Progress;

/// The number of squares that a request asks for: as given, or the fewest whose triangles have no edge
/// longer than asked.
Divisions divisions(const Rectangle& domain, const MeshRequest& request);

/// Squares along x and y, each cut by the pattern; parts `left`, `right`, `bottom`, `top`, their edges in
/// ascending x or y. Throws what a Progress throws, if there is one.
Mesh rectangle_mesh(const Rectangle& domain, const Divisions& squares, Pattern pattern,
                    Progress* progress = nullptr);

/// The names of the parts of a rectangle, in the order in which the mesh has them.
const std::vector<std::string>& rectangle_parts();

}  // namespace signorini
