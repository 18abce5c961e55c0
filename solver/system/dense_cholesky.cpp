#include "system/dense_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cblas.h>

#include "progress/pace.hpp"
#include "system/elimination_in_blocks.hpp"
#include "system/factor.hpp"

namespace signorini {
namespace {

Eigen::MatrixXd lower_part(const Eigen::MatrixXd& matrix, const std::vector<int>& chosen,
                           Progress& progress) {
  const auto n = static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd lower = unset_square(n);
  Pace pace(progress);
  for (Eigen::Index j = 0; j < n; ++j) {
    pace.add(static_cast<std::size_t>(n - j));
    for (Eigen::Index i = j; i < n; ++i) lower(i, j) = matrix(chosen[i], chosen[j]);
  }
  return lower;
}

}  // namespace

DenseCholesky::DenseCholesky(const Eigen::MatrixXd& matrix, const std::vector<int>& chosen,
                             Progress& progress)
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

Eigen::VectorXd DenseCholesky::solve(Eigen::VectorXd b, Progress& progress) const {
  constexpr int kBlock = 128;
  const int n = static_cast<int>(b.size()), blocks = (n + kBlock - 1) / kBlock;
  Pace pace(progress);
  const auto for_block = [&](int block, const auto& step) {
    const int begin = block * kBlock, own = std::min(kBlock, n - begin), below = n - begin - own;
    step(own, below, &factor_(begin, begin), b.data() + begin, b.data() + begin + own);
    pace.add(static_cast<std::size_t>(own) * (own + below));
  };
  for (int block = 0; block < blocks; ++block)
    for_block(block, [n](int own, int below, const double* columns, double* x, double* rest) {
      cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, own, columns, n, x, 1);
      cblas_dgemv(CblasColMajor, CblasNoTrans, below, own, -1, columns + own, n, x, 1, 1, rest, 1);
    });
  for (int block = blocks - 1; block >= 0; --block)
    for_block(block, [n](int own, int below, const double* columns, double* x, const double* rest) {
      cblas_dgemv(CblasColMajor, CblasTrans, below, own, -1, columns + own, n, rest, 1, 1, x, 1);
      cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, own, columns, n, x, 1);
    });
  return b;
}

}  // namespace signorini
