#pragma once

#include <algorithm>

#include <cblas.h>

#include "progress/progress.hpp"
#include "system/in_strips.hpp"
#include "system/symmetric_update.hpp"

extern "C" void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);

namespace signorini {

/// Eliminates the first columns, `pivots`, of a dense symmetric matrix with so many rows, of which it holds
/// the lower triangle, column by column with the given distance: they become those of the Cholesky factor. By
/// blocks, between which it looks at the observer; `after_block(begin, width)` may use the columns that are
/// done. False if a pivot is not positive. Throws what Progress throws.
template <typename AfterBlock>
bool eliminate_in_blocks(int rows, int pivots, double* matrix, int distance, Progress& progress,
                         const AfterBlock& after_block) {
  constexpr int kBlock = 256, kStrip = 256;
  const auto at = [&](int row, int column) {
    return matrix + static_cast<std::ptrdiff_t>(column) * distance + row;
  };
  for (int begin = 0; begin < pivots; begin += kBlock) {
    progress.check();
    const int width = std::min(kBlock, pivots - begin), end = begin + width;
    int info = 0;
    dpotrf_("L", &width, at(begin, begin), &distance, &info);
    if (info != 0) return false;
    const int below = rows - end;
    in_strips((below + kStrip - 1) / kStrip, static_cast<double>(below) * width * width, progress,
              [&](int strip, Progress& its) {
                its.check();
                const int top = end + strip * kStrip;
                cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit,
                            std::min(kStrip, rows - top), width, 1, at(begin, begin), distance,
                            at(top, begin), distance);
              });
    if (end < pivots)
      subtract_square(rows - end, pivots - end, width, at(end, begin), distance, at(end, end), distance,
                      progress);
    after_block(begin, width);
  }
  return true;
}

}  // namespace signorini
