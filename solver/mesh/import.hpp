#pragma once

#include "mesh/mesh.hpp"
#include "problem/domain.hpp"

namespace signorini {

class Progress;

/// The mesh of the data, its points and triangles in the same order. Triangles that run clockwise are
/// turned; the edges of a part run with the domain on their left, in chains where they form some.
///
/// Throws InvalidProblem with the offending numbers and their pointers (`/domain/points/7`,
/// `/domain/triangles/3`, `/domain/boundary/top/0`) for: numbers of points that do not exist; points that are
/// not finite, repeat another or belong to no triangle; triangles that are degenerate (area below 1e-8 of
/// the squared longest edge), repeated or overlap; edges of three triangles; hanging nodes; names that are
/// empty, repeated or `all`; edges in a part that are not on the boundary, in two parts or in none.
/// Points closer to each other or to an edge than 1e-9 of the edge's length count as touching. Throws what a
/// Progress throws; without one it leaves overlaps aside where the boxes of very many edges meet.
Mesh import_mesh(const MeshData& data, Progress* progress = nullptr);

/// The same of data in which nothing touches or overlaps; that is not looked for.
Mesh import_sound_mesh(const MeshData& data);

}  // namespace signorini
