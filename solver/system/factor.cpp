#include "system/factor.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include <cblas.h>

#include "progress/pace.hpp"

namespace signorini {

NotPositiveDefinite::NotPositiveDefinite() : std::runtime_error("the matrix is not positive definite") {}
OutOfMemory::OutOfMemory() : std::runtime_error("out of memory in the factorisation") {}

Numbers allocate_numbers(std::size_t count) {
  if (count > std::numeric_limits<std::size_t>::max() / sizeof(double)) throw OutOfMemory();
  // At least one, for malloc() may answer null if nothing is asked for.
  void* const memory = std::malloc(std::max<std::size_t>(count, 1) * sizeof(double));
  if (memory == nullptr) throw OutOfMemory();
  return Numbers(static_cast<double*>(memory));
}

Eigen::MatrixXd unset_square(Eigen::Index size) {
  Eigen::MatrixXd square;
  try {
    square.resize(size, size);
  } catch (const std::bad_alloc&) {
    throw OutOfMemory();
  }
  return square;
}

void require_stiffness(std::span<const int> unknowns, int pivots, const double* columns,
                       const std::vector<double>& diagonal) {
  constexpr double rounding = 1e-13;
  const std::size_t next = unknowns.size() + 1;
  for (int k = 0; k < pivots; ++k) {
    const double pivot = columns[static_cast<std::size_t>(k) * next];
    if (!(pivot * pivot >= rounding * diagonal[unknowns[k]])) throw NotPositiveDefinite();
  }
}

namespace {

using Rows = Eigen::Map<Eigen::VectorXd>;
using GivenRows = Eigen::Map<const Eigen::VectorXd>;

/// Panels with up to so many numbers are gone through without BLAS, a call of which takes longer.
constexpr int kFewNumbers = 600;

bool is_small(const Panels::Panel& panel) {
  return panel.size * panel.pivots <= kFewNumbers;
}

/// x_p = L_pp⁻¹ x_p, and what that takes off the other rows: rest = −L_rp x_p.
void eliminate(const Panels::Panel& panel, const double* columns, double* x) {
  const int m = panel.size, p = panel.pivots;
  if (!is_small(panel)) {
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, p, columns, m, x, 1);
    cblas_dgemv(CblasColMajor, CblasNoTrans, m - p, p, -1, columns + p, m, x, 1, 0, x + p, 1);
    return;
  }
  std::fill(x + p, x + m, 0.);
  for (int k = 0; k < p; ++k, columns += m) {
    x[k] /= columns[k];
    Rows(x + k + 1, m - k - 1) -= x[k] * GivenRows(columns + k + 1, m - k - 1);
  }
}

/// x_p = L_pp⁻ᵀ (x_p − L_rpᵀ x_r).
void substitute(const Panels::Panel& panel, const double* columns, double* x) {
  const int m = panel.size, p = panel.pivots;
  if (!is_small(panel)) {
    cblas_dgemv(CblasColMajor, CblasTrans, m - p, p, -1, columns + p, m, x + p, 1, 1, x, 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, p, columns, m, x, 1);
    return;
  }
  for (int k = p - 1; k >= 0; --k) {
    const double* column = columns + static_cast<std::ptrdiff_t>(k) * m;
    x[k] -= GivenRows(column + k + 1, m - k - 1).dot(GivenRows(x + k + 1, m - k - 1));
    x[k] /= column[k];
  }
}

}  // namespace

Factor::Factor(Panels panels, Eigen::MatrixXd complement, std::shared_ptr<const ElementTree> tree)
    : panels_(std::move(panels)), complement_(std::move(complement)), tree_(std::move(tree)) {
  for (const Panels::Panel& panel : panels_.all) largest_ = std::max(largest_, panel.size);
}

void Factor::forward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const {
  workspace.front.resize(largest_);
  double* local = workspace.front.data();
  Pace pace(progress);
  for (const Panels::Panel& panel : panels_.all) {
    const auto unknowns = panels_.unknowns_of(panel);
    const int m = panel.size, p = panel.pivots;
    pace.add(static_cast<std::size_t>(m) * p);
    for (int k = 0; k < p; ++k) local[k] = x[unknowns[k]];
    // A support that moves pulls at few unknowns: most pieces have nothing to pass on.
    if (std::none_of(local, local + p, [](double pull) { return pull != 0; })) continue;
    eliminate(panel, panels_.columns(panel), local);
    for (int k = 0; k < p; ++k) x[unknowns[k]] = local[k];
    for (int k = p; k < m; ++k) x[unknowns[k]] += local[k];
  }
}

void Factor::backward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const {
  workspace.front.resize(largest_);
  double* local = workspace.front.data();
  Pace pace(progress);
  for (auto last = panels_.all.rbegin(); last != panels_.all.rend(); ++last) {
    const Panels::Panel& panel = *last;
    const auto unknowns = panels_.unknowns_of(panel);
    const int m = panel.size, p = panel.pivots;
    pace.add(static_cast<std::size_t>(m) * p);
    for (int k = 0; k < m; ++k) local[k] = x[unknowns[k]];
    substitute(panel, panels_.columns(panel), local);
    for (int k = 0; k < p; ++k) x[unknowns[k]] = local[k];
  }
}

Factor::Condensed Factor::condense(const Eigen::VectorXd& b, Workspace& workspace, Progress& progress) const {
  Condensed condensed{b, {}};
  forward(condensed.forward, workspace, progress);
  condensed.trailing = condensed.forward.tail(complement_.rows());
  return condensed;
}

Eigen::VectorXd Factor::expand(const Condensed& b, const Eigen::VectorXd& trailing, Workspace& workspace,
                               Progress& progress) const {
  Eigen::VectorXd x = b.forward;
  x.tail(complement_.rows()) = trailing;
  backward(x, workspace, progress);
  return x;
}

void Factor::solve(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const {
  forward(x, workspace, progress);
  backward(x, workspace, progress);
}

std::size_t Factor::bytes() const {
  const std::size_t numbers = panels_.count + static_cast<std::size_t>(complement_.size());
  return sizeof(Factor) + numbers * sizeof(double) + panels_.all.capacity() * sizeof(Panels::Panel) +
         panels_.unknowns.capacity() * sizeof(int) + (tree_ ? tree_->bytes() : 0);
}

}  // namespace signorini
