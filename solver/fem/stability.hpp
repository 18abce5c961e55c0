#pragma once

#include "mesh/mesh.hpp"
#include "mesh/mesh_sizes.hpp"
#include "problem/problem.hpp"

namespace signorini {

class Progress;

/// A mesh on which the pair of spaces for elasticity is stable: the given one, or where it is not, one with
/// the triangles halved that make it so, and a note that says so.
///
/// Both pairs control every rotation on triangles without slivers but two kinds.
///
/// `nonconforming`: the bubbles of PEERS control ∇γ on each triangle, so that what is left is a rotation of
/// the whole body, with which the traces move as a rigid body does. The supports must prevent it, but P0
/// traces see of a support only the mean on each edge, which is the displacement of its middle: a body held
/// by one edge turns about the middle of that edge at no cost. So the supports are measured both ways, by the
/// integral of r_d² over their edges for rigid motions r, and by that of the squares of its means on the
/// edges. No motion that the first prevents may be seen by the second with less than a quarter. Halving every
/// edge of a support makes it three quarters at least, as the midpoint rule for squares of linear functions
/// tells. Those that hold the body without contact are measured by themselves first, as contact may open.
///
/// `conforming`: P1 traces see the ends of each edge, and curls of P2 vectors control ∇γ by the Taylor–Hood
/// pair, which is stable from three triangles on (Boffi 1994). A body of one or two triangles has too few
/// edges, unless enough of them are held.
///
/// Throws what a Progress throws, if there is one.
Mesh stabilized(const Problem& problem, Mesh mesh, Progress* progress = nullptr);

/// The sizes of that mesh, nearly, of a given one with these sizes that nobody has made. Its triangles are of
/// points that exist.
MeshSizes stabilized(const Problem& problem, const MeshData& data, MeshSizes sizes);

}  // namespace signorini
