#pragma once

#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// The order in which CHOLMOD eliminates: that of our nested dissection (system/dissection.hpp), or its own,
/// a minimum degree with constraints (CAMD).
enum class CholmodOrder { given, own };

/// Factors by CHOLMOD's supernodes (Chen, Davis, Hager, Rajamanickam 2008): the same factor as multifrontal()
/// but for the order and rounding.
///
/// Nothing interrupts CHOLMOD within its analysis or its numbers: the observer is asked between them. It
/// starts no thread; what it allocates counts for MemoryMeter and MemoryLimit.
///
/// Throws NotPositiveDefinite if K_II is not, OutOfMemory, and what Progress throws.
Factor cholmod(const ElementSum& matrix, int trailing, Progress& progress,
               CholmodOrder order = CholmodOrder::given);

}  // namespace signorini
