#pragma once

#include "mesh/mesh.hpp"
#include "solve.hpp"

namespace signorini {

/// estimate() on a mesh that is there.
Estimate estimate(const Problem& problem, const Mesh& mesh, Factorization by);

/// No run of a study has more stress unknowns, by the sizes of its meshes alone: of a polygon rather too
/// many.
std::int64_t most_stress_unknowns(const Problem& problem, const Study& study);

}  // namespace signorini
