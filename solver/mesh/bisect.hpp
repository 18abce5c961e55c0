#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

class Progress;

/// The mesh with the vertices of every triangle turned so that its longest edge lies opposite the first one:
/// what bisect() takes for the edge to be halved. Of edges of the same length that of the largest number is
/// taken, by both of its triangles.
Mesh with_longest_edges_first(Mesh mesh);

/// The mesh with its triangles in the order of mesh/corner_order.hpp: one that is not to be cut further.
Mesh with_lowest_corners_first(Mesh mesh);

/// Newest-vertex bisection (Mitchell 1991): halves the edges of the marked triangles, and as many others as
/// it takes to keep the mesh conforming. A triangle is halved from its first vertex, and each half has the
/// new point for its first vertex, so that the descendants of a triangle have at most four shapes, however
/// often they are cut; next to an arc, whose midpoint takes the place of that of its chord, nearly so. The
/// points keep their numbers, and the parts their names and the order of their edges. Throws as
/// require_upright() does, and what a Progress throws, if there is one.
Mesh bisect(const Mesh& mesh, const std::vector<int>& marked, Progress* progress = nullptr);

/// The same for the body that the mesh is: of an arc's chord the midpoint is taken, so that every new
/// triangle is part of one, which `parents` tells.
Mesh bisect(const Mesh& mesh, const std::vector<int>& marked, std::vector<int>& parents,
            Progress* progress = nullptr);

}  // namespace signorini
