#include "certify/displacement/largest_coefficient.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace signorini {

/// Short parts tell more: they become shorter until less than `small` is left, or as long as that helps. Each
/// reaches into its neighbours: where two meet the field may have a kink of which neither shows anything.
double largest_coefficient(const Field& field, const EdgeLine& line, int order, double small) {
  constexpr int kMostCuts = 256;
  constexpr double kOverlap = 0.125;
  double known = std::numeric_limits<double>::infinity();
  for (int cuts = 4; cuts <= kMostCuts; cuts *= 4) {
    double most = 0;
    for (int i = 0; i < cuts; ++i) {
      const Interval part(std::max(0., (i - kOverlap) / cuts), std::min(1., (i + 1 + kOverlap) / cuts));
      const Interval own = series_on(field, line, part, order)[order];
      most = std::max(most, is_known(own) ? largest(own) : std::numeric_limits<double>::infinity());
    }
    const bool helps = most < 0.9 * known;
    known = std::min(known, most);
    if (known <= small || (!helps && std::isfinite(known))) break;
  }
  return known;
}

}  // namespace signorini
