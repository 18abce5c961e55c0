#pragma once

#include "problem/settings.hpp"
#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// The factor of K but for its trailing unknowns, and what it leaves of them: the same by each factorisation,
/// but for rounding. Throws NotPositiveDefinite if K_II is not, OutOfMemory, and what Progress throws.
Factor factorize(const ElementSum& matrix, int trailing, Factorization by, Progress& progress);

}  // namespace signorini
