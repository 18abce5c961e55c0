#pragma once

#include "mesh/mesh.hpp"
#include "mesh/most_triangles.hpp"
#include "problem/domain.hpp"

namespace signorini {

class Progress;

/// Vertices, arcs and holes that a polygon may have, those of its holes included; and local sizes.
inline constexpr int most_vertices = 10'000, most_arcs = 500, most_holes = 2000, most_local_sizes = 500;

/// The mesh would have more triangles than allowed.
class TooManyTriangles : public InvalidProblem {
 public:
  using InvalidProblem::InvalidProblem;
};

/// Every fault of the polygon, with its pointer: `/domain/vertices/3`, `/domain/holes/0/2`, `/domain/sides`.
/// Edges cross where the chords do that stand for arcs.
/// Points, and points and edges, closer than 1e-9 of the domain's extent count as touching.
std::vector<Fault> validate(const Polygon& polygon);

/// Every fault of the sizes that a mesh of the polygon (which has no fault) is asked for, at `/mesh/size` and
/// `/mesh/sizes`: not positive, or so small that the mesh would surely have more triangles than allowed.
std::vector<Fault> validate(const Polygon& polygon, double size, const std::vector<LocalSize>& sizes,
                            int max_triangles = most_triangles);

/// The names of the parts in the order in which the mesh has them.
std::vector<std::string> part_names(const Polygon& polygon);

/// The area of the polygon without its holes, with few chords for its arcs.
double area(const Polygon& polygon);

/// A Delaunay mesh whose edges are no longer than `size` (but for rounding) nor than the local sizes, and
/// whose angles are above 20.7° but where the polygon's own angles are smaller. An arc is made of chords that
/// span at most an eighth of the straight angle and are as short as the sizes ask; all points on it lie on
/// its circle, for which edges and angles may miss their bounds by a little.
///
/// The vertices of the polygon, and between those of an arc the ends of its first chords, are the first
/// points of the mesh, bit for bit: the outer ring, then the holes. The edges of a part run with the domain
/// on their left. Equal input gives equal meshes. Throws InvalidProblem for the faults that validate names,
/// TooManyTriangles at `/mesh/size`, and what a Progress throws, if there is one.
Mesh polygon_mesh(const Polygon& polygon, double size, const std::vector<LocalSize>& sizes = {},
                  int max_triangles = most_triangles, Progress* progress = nullptr);

}  // namespace signorini
