#pragma once

#include "fem/inf_sup_forms.hpp"

namespace signorini {

/// The constant β_h of the Babuška–Brezzi condition for the spaces of the problem's scheme on the mesh
/// (solver/README.md, "The inf-sup constant"): a number without unit, the same in all units of length and for
/// every material, load and gap. 0, but for rounding, where the conditions other than contact leave a body a
/// rigid motion.
///
/// Throws what Progress throws, and SolveError where the eigenvalue is not found.
double inf_sup_constant(const Problem& problem, const Mesh& mesh, Progress& progress,
                        Bubbles bubbles = Bubbles::kept);

}  // namespace signorini
