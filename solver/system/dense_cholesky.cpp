#include "system/dense_cholesky.hpp"

#include <cmath>
#include <limits>
#include <new>

#include <cblas.h>

#include "system/cholesky.hpp"
#include "system/elimination_in_blocks.hpp"
#include "system/pace.hpp"

namespace signorini {
namespace {

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
  positive_ = eliminate_in_blocks(n, n, factor_.data(), n, progress, [](int, int) {});
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
