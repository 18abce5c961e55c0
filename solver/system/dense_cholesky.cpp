#include "system/dense_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include <cblas.h>

#include "system/cholesky.hpp"
#include "system/lapack.hpp"
#include "system/pace.hpp"
#include "system/symmetric_update.hpp"

namespace signorini {
namespace {

/// Columns that are eliminated at a time.
constexpr int kBlock = 256;

Eigen::MatrixXd lower_part(const Eigen::MatrixXd& matrix, const std::vector<int>& chosen, Progress& progress) {
  const auto n = static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd lower;
  try {
    lower.resize(n, n);
  } catch (const std::bad_alloc&) {
    throw OutOfMemory();
  }
  Pace pace(progress);
  for (Eigen::Index j = 0; j < n; ++j) {
    pace.add(static_cast<std::size_t>(n - j));
    for (Eigen::Index i = j; i < n; ++i) lower(i, j) = matrix(chosen[i], chosen[j]);
  }
  return lower;
}

}  // namespace

DenseCholesky::DenseCholesky(const Eigen::MatrixXd& matrix, const std::vector<int>& chosen, Progress& progress)
    : factor_(lower_part(matrix, chosen, progress)) {
  const int n = static_cast<int>(chosen.size());
  for (int begin = 0; begin < n && positive_; begin += kBlock) {
    progress.check();
    const int width = std::min(kBlock, n - begin), end = begin + width, below = n - end;
    double* diagonal = &factor_(begin, begin);
    positive_ = factorize_lower(width, diagonal, n);
    if (!positive_ || below == 0) continue;
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, below, width, 1, diagonal, n,
                diagonal + width, n);
    subtract_square(below, below, width, diagonal + width, n, &factor_(end, end), n, progress);
  }
}

double DenseCholesky::smallest_pivot() const {
  return factor_.size() == 0 ? std::numeric_limits<double>::infinity()
                             : std::pow(factor_.diagonal().minCoeff(), 2);
}

double DenseCholesky::largest_pivot() const {
  return factor_.size() == 0 ? 0 : std::pow(factor_.diagonal().maxCoeff(), 2);
}

Eigen::VectorXd DenseCholesky::solve(Eigen::VectorXd b) const {
  const int n = static_cast<int>(b.size());
  if (n == 0) return b;
  cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, factor_.data(), n, b.data(), 1);
  cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, n, factor_.data(), n, b.data(), 1);
  return b;
}

}  // namespace signorini
