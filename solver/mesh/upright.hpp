#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

/// Throws InvalidProblem at `/mesh/size` if a triangle of the mesh does not run counter-clockwise: the new
/// points of arcs, which lie beside their chords, have turned it over.
void require_upright(const Mesh& mesh);

}  // namespace signorini
