#include "system/symmetric_update.hpp"

#include <algorithm>
#include <cstdint>

#include <cblas.h>

#include "system/in_strips.hpp"

namespace signorini {

void subtract_square(int rows, int columns, int width, const double* b, int distance_b, double* a,
                     int distance_a, Progress& progress) {
  if (columns == 0 || width == 0) return;
  // Products of a strip, and the fewest columns with which BLAS is fast.
  constexpr std::int64_t kProducts = 1 << 26;
  constexpr int kFewest = 64;
  const int most =
      std::max<int>(kFewest, static_cast<int>(kProducts / (static_cast<std::int64_t>(rows) * width)));
  const int strips = (columns - 1) / most + 1;
  in_strips(strips, static_cast<double>(rows) * width * columns, progress, [=](int strip, Progress& its) {
    its.check();
    const int begin = strip * most, own = std::min(most, columns - begin), below = rows - begin - own;
    double* diagonal = a + static_cast<std::ptrdiff_t>(begin) * distance_a + begin;
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, own, width, -1, b + begin, distance_b, 1, diagonal,
                distance_a);
    if (below > 0)
      cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, below, own, width, -1, b + begin + own, distance_b,
                  b + begin, distance_b, 1, diagonal + own, distance_a);
  });
}

}  // namespace signorini
