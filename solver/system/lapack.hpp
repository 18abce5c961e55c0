#pragma once

extern "C" void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);

namespace signorini {

/// The Cholesky factor of the lower triangle of a matrix in place (LAPACK's dpotrf); false if it is not positive
/// definite.
inline bool factorize_lower(int size, double* matrix, int distance) {
  int info = 0;
  dpotrf_("L", &size, matrix, &distance, &info);
  return info == 0;
}

}  // namespace signorini
