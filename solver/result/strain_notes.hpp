#pragma once

#include <string>
#include <vector>

#include "solution.hpp"

namespace signorini {

/// What must be said of an elastic body that deforms more than the theory of small displacements describes:
/// that leaves out ½ ∇uᵀ∇u beside ε(u), and lets a body pass through itself. `solution` has its displacement
/// at the points.
std::vector<std::string> notes_on_strains(const Solution& solution);

}  // namespace signorini
