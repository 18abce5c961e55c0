#pragma once

#include "progress/observer.hpp"

namespace signorini {

/// Numbers of a solve leave the range of double precision.
struct Overflow : SolveError {
  Overflow()
      : SolveError(
            "the numbers of this problem leave the range of double precision: choose units in which loads, "
            "moduli, lengths, rho and augmentation lie closer to 1") {}
};

}  // namespace signorini
