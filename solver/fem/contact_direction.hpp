#pragma once

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"

namespace signorini {

/// The unit vector along which a contact edge of the part takes u_n. Throws InvalidProblem if it does not
/// point out of the body.
Vector contact_direction(const Mesh& mesh, const BoundaryPart& part, const Contact& contact, int edge);

}  // namespace signorini
