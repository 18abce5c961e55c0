#pragma once

#include "mesh/mesh.hpp"
#include "mesh/most_triangles.hpp"

namespace signorini {

class Progress;

/// Cuts every triangle into four by the midpoints of its edges, so many times over: similar ones, but where
/// the midpoint of an arc takes the place of that of its chord. The points keep their numbers, and the parts
/// their names and the order of their edges. Throws InvalidProblem at `/mesh/refine` if there would be more
/// triangles than allowed, and as require_upright() does, and what a Progress
/// throws, if there is one.
Mesh refine(const Mesh& mesh, int times, int max_triangles = most_triangles, Progress* progress = nullptr);

}  // namespace signorini
