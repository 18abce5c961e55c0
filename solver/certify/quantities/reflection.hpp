#pragma once

#include "certify/quantities/certified_solution.hpp"
#include "problem/quantity.hpp"

namespace signorini {

/// Whether the pair 2 base − plus is admissible for neighbour(problem, quantity, −z), `plus` being the
/// solution of neighbour(problem, quantity, z): of all its conditions v_n ≤ g and p* ≥ 0 alone are
/// inequalities. Looks at edges of Γ_C only; false where it cannot tell.
bool is_admissible_reflected(const CertifiedSolution& base, const CertifiedSolution& plus,
                             const Quantity& quantity, double z, Progress& progress);

}  // namespace signorini
