#pragma once

#include "progress/progress.hpp"

namespace signorini {

/// A −= B Bᵀ in the lower triangle of the first columns of A: rows × columns of A, rows × width of B, column
/// by column with the given distances between columns. Between strips of columns it looks at the observer, so
/// that no call of BLAS takes longer than some milliseconds.
void subtract_square(int rows, int columns, int width, const double* b, int distance_b, double* a,
                     int distance_a, Progress& progress);

}  // namespace signorini
