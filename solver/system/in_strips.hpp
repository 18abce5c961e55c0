#pragma once

#include "progress/in_parts.hpp"

namespace signorini {

/// Does the strips of a dense product, work(strip, progress), side by side if its multiplications are worth
/// waking another thread, some tenths of a millisecond of a core. Throws what side_by_side() throws.
template <typename Work>
void in_strips(int strips, double multiplications, Progress& progress, const Work& work) {
  constexpr double worth_it = 1 << 22;
  if (multiplications >= worth_it) return side_by_side(strips, progress, work);
  for (int strip = 0; strip < strips; ++strip) work(strip, progress);
}

}  // namespace signorini
