#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

/// The mesh with no triangle that has more than one edge on the boundary, as the pairs for elasticity want
/// it: with two of them, little controls the rotation at the corner between them.
///
/// The interior edge of a corner triangle is halved, and the triangles on both sides of it with it; a
/// triangle whose edges all lie on the boundary is cut at its centroid. Angles shrink by a bounded factor.
/// The points keep their numbers, the new ones come behind them; the
/// parts and all other triangles stay as they are. A mesh without such triangles is returned unchanged.
Mesh split_corners(const Mesh& mesh);

/// A mesh on which the pairs for elasticity are closer to stable: its corners split, or if it has none, every
/// triangle cut into four. A note says so.
Mesh mend(const Mesh& mesh);

}  // namespace signorini
