#pragma once

#include "mesh/mesh.hpp"
#include "solve.hpp"

namespace signorini {

/// estimate() on a mesh that is there.
Estimate estimate(const Problem& problem, const Mesh& mesh, Factorization by);

}  // namespace signorini
