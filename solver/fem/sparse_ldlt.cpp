#include "fem/sparse_ldlt.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/OrderingMethods>

#include "progress/pace.hpp"

namespace signorini {

using Sparse = Eigen::SparseMatrix<double>;

SingularPivot::SingularPivot() : std::runtime_error("a pivot is zero") {}

SparseLdlt::SparseLdlt(const Sparse& lower, Progress& progress) {
  progress.check();
  Permutation backward;
  Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), backward);
  order_ = backward.inverse();
  progress.check();
  Sparse upper(lower.rows(), lower.cols());
  upper.selfadjointView<Eigen::Upper>() = lower.selfadjointView<Eigen::Lower>().twistedBy(order_);
  count(upper);
  factor(upper, progress);
}

/// The elimination tree, and how many entries each column has: row k has one in every column on the ways up
/// the tree from the entries of the matrix in that row.
void SparseLdlt::count(const Sparse& upper) {
  const int n = static_cast<int>(upper.cols());
  parent_.assign(n, -1);
  first_.assign(n + 1, 0);
  std::vector<int> reached(n, -1);  // the row that was here last
  for (int k = 0; k < n; ++k) {
    reached[k] = k;
    for (Sparse::InnerIterator entry(upper, k); entry; ++entry)
      for (int i = static_cast<int>(entry.row()); reached[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        reached[i] = k;
        ++first_[i + 1];
      }
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

void SparseLdlt::factor(const Sparse& upper, Progress& progress) {
  const int n = static_cast<int>(upper.cols());
  rows_.resize(first_[n]);
  values_.resize(first_[n]);
  diagonal_.resize(n);
  Pace pace(progress);
  std::vector<std::size_t> end(first_.begin(), first_.end() - 1);  // of what each column has so far
  std::vector<int> reached(n, -1), way, columns(n);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(n);  // of the matrix, less what is eliminated
  for (int k = 0; k < n; ++k) {
    reached[k] = k;
    int top = n;  // the columns with an entry in row k stand behind it, each before those that it leads to
    for (Sparse::InnerIterator entry(upper, k); entry; ++entry) {
      row[entry.row()] = entry.value();
      way.clear();
      for (int i = static_cast<int>(entry.row()); reached[i] != k; i = parent_[i]) {
        way.push_back(i);
        reached[i] = k;
      }
      top -= static_cast<int>(way.size());
      std::ranges::copy(way, columns.begin() + top);
    }
    double pivot = std::exchange(row[k], 0);
    for (int at = top; at < n; ++at) {
      const int i = columns[at];
      const double own = std::exchange(row[i], 0), factor = own / diagonal_[i];
      for (std::size_t p = first_[i]; p < end[i]; ++p) row[rows_[p]] -= values_[p] * own;
      pace.add(end[i] - first_[i]);
      pivot -= factor * own;
      rows_[end[i]] = k;
      values_[end[i]++] = factor;
    }
    if (pivot == 0) throw SingularPivot();
    diagonal_[k] = pivot;
  }
}

Eigen::VectorXd SparseLdlt::solve(const Eigen::VectorXd& b, Progress& progress) const {
  const int n = static_cast<int>(diagonal_.size());
  Eigen::VectorXd x = order_ * b;
  Pace pace(progress);
  for (int k = 0; k < n; ++k) {
    for (std::size_t p = first_[k]; p < first_[k + 1]; ++p) x[rows_[p]] -= values_[p] * x[k];
    pace.add(first_[k + 1] - first_[k]);
  }
  x.array() /= diagonal_.array();
  for (int k = n - 1; k >= 0; --k) {
    for (std::size_t p = first_[k]; p < first_[k + 1]; ++p) x[k] -= values_[p] * x[rows_[p]];
    pace.add(first_[k + 1] - first_[k]);
  }
  return order_.transpose() * x;
}

}  // namespace signorini
