#pragma once

#include <string_view>

#include "problem/domain.hpp"

namespace signorini::api {

/// The triangles of a .msh file of Gmsh (ASCII, version 2.2 or 4.1), and its lines in physical groups as the
/// parts of the boundary, named as the groups or by their numbers; lines in no group are left out, and so
/// are nodes of no triangle. Points and triangles are numbered from 0 in the order of the file.
///
/// Throws InvalidProblem at `/domain/msh` with the line for what is no such file, and for other elements
/// than points, lines and triangles of the first order, a z that is not constant, and nodes that do not
/// exist, and for curves in several physical groups, for a line is in one part. A constant z other than 0 is
/// left out, and noted. The partitions that elements of version 2.2 belong to do not matter; version 4.1 has
/// other entities in a partitioned mesh, which is refused. Whether the triangles form a mesh is for
/// import_mesh to see.
MeshData parse_gmsh(std::string_view text);

}  // namespace signorini::api
