#include "system/cholmod.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <cholmod.h>

#include "progress/pace.hpp"
#include "system/dissection.hpp"
#include "system/symmetric_update.hpp"
extern "C" void omp_set_max_active_levels(int levels);

namespace signorini {
namespace {

static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));

/// CHOLMOD's functions, so that what it allocates is counted as all that is linked with the solver.
void count_memory() {
  [[maybe_unused]] static const bool done = [] {
    SuiteSparse_config.malloc_func = [](std::size_t size) { return std::malloc(size); };
    SuiteSparse_config.calloc_func = [](std::size_t count, std::size_t size) {
      return std::calloc(count, size);
    };
    SuiteSparse_config.realloc_func = [](void* old, std::size_t size) { return std::realloc(old, size); };
    SuiteSparse_config.free_func = [](void* memory) { std::free(memory); };
    return true;
  }();
}

/// CHOLMOD's settings and work space.
class Common {
 public:
  Common() {
    count_memory();
    // Debian's CHOLMOD would take four threads of OpenMP for its loops, whatever the machine has.
    omp_set_max_active_levels(0);
    cholmod_l_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    // It would take the trailing unknowns from the end.
    common_.postorder = 0;
  }
  ~Common() { cholmod_l_finish(&common_); }

  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;

  cholmod_common* get() { return &common_; }

  /// What the last call has met.
  void check() const {
    if (common_.status == CHOLMOD_NOT_POSDEF) throw NotPositiveDefinite();
    if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE) throw OutOfMemory();
    if (common_.status != CHOLMOD_OK)
      throw std::logic_error("CHOLMOD ended with status " + std::to_string(common_.status));
  }

 private:
  cholmod_common common_;
};

/// Something of CHOLMOD's, freed by its own function.
template <typename Of, int (*free)(Of**, cholmod_common*)>
struct Release {
  Common* common;
  void operator()(Of* made) const { free(&made, common->get()); }
};
template <typename Of, int (*free)(Of**, cholmod_common*)>
using Owned = std::unique_ptr<Of, Release<Of, free>>;

using Sparse = Owned<cholmod_sparse, cholmod_l_free_sparse>;
using Triplets = Owned<cholmod_triplet, cholmod_l_free_triplet>;
using Supernodes = Owned<cholmod_factor, cholmod_l_free_factor>;

/// What a call has made, unless it has failed.
template <typename Pointer>
Pointer owned(typename Pointer::pointer made, Common& common) {
  Pointer owner(made, {&common});
  common.check();
  return owner;
}

/// The numbers of one of CHOLMOD's arrays.
const SuiteSparse_long* indices(const void* array) {
  return static_cast<const SuiteSparse_long*>(array);
}

/// The lower triangle of K with `added` on the diagonal of its trailing unknowns.
Sparse put_together(const ElementSum& sum, const std::vector<double>& added, Common& common,
                    Progress& progress) {
  const std::size_t n = sum.per_element, size = sum.size;
  const std::size_t most = static_cast<std::size_t>(sum.elements()) * n * (n + 1) / 2 + added.size();
  const auto triplets =
      owned<Triplets>(cholmod_l_allocate_triplet(size, size, most, -1, CHOLMOD_REAL, common.get()), common);
  std::size_t& count = triplets->nnz;
  const auto add = [&](int row, int column, double value) {
    static_cast<SuiteSparse_long*>(triplets->i)[count] = row;
    static_cast<SuiteSparse_long*>(triplets->j)[count] = column;
    static_cast<double*>(triplets->x)[count++] = value;
  };
  for (int element = 0; element < sum.elements(); ++element) {
    progress.check_in(element);
    const auto unknowns = sum.unknowns_of(element);
    const double* values = sum.matrix(element);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = j; i < n; ++i) {
        if (unknowns[i] < 0 || unknowns[j] < 0) continue;
        // Two rows of an element may be one unknown; then both orders of the pair fall on the diagonal.
        const bool falls_twice = i != j && unknowns[i] == unknowns[j];
        add(std::max(unknowns[i], unknowns[j]), std::min(unknowns[i], unknowns[j]),
            values[j * n + i] + (falls_twice ? values[i * n + j] : 0));
      }
  }
  int trailing = sum.size - static_cast<int>(added.size());
  for (const double entry : added) {
    add(trailing, trailing, entry);
    ++trailing;
  }
  progress.check();
  return owned<Sparse>(cholmod_l_triplet_to_sparse(triplets.get(), 0, common.get()), common);
}

using Permutation = std::vector<SuiteSparse_long>;

/// The pivots of the pieces, and the trailing unknowns behind them.
Permutation by_dissection(const ElementSum& sum, int trailing, Progress& progress) {
  const Dissection dissection(sum, trailing, progress);
  Permutation order;
  order.reserve(sum.size);
  dissection.for_each_piece([&](int piece) {
    const Dissection::Front front = dissection.front(piece);
    const auto pivots = front.unknowns.first(front.pivots);
    order.insert(order.end(), pivots.begin(), pivots.end());
  });
  for (int i = sum.size - trailing; i < sum.size; ++i) order.push_back(i);
  return order;
}

Permutation by_minimum_degree(cholmod_sparse* matrix, int trailing, Common& common) {
  Permutation order(matrix->nrow), group(matrix->nrow, 0);
  std::fill(group.end() - trailing, group.end(), 1);
  // Groups are numbered without gaps.
  if (group.size() == static_cast<std::size_t>(trailing)) std::ranges::fill(group, 0);
  cholmod_l_camd(matrix, nullptr, 0, group.data(), order.data(), common.get());
  common.check();
  return order;
}

/// What CHOLMOD has made, as panels of the leading unknowns and, dense and row by row in the order of the
/// trailing unknowns, their part of the factor.
class Taken {
 public:
  Taken(cholmod_factor* factor, int trailing, Progress& progress)
      : leading_(static_cast<SuiteSparse_long>(factor->n) - trailing), factor_(factor), pace_(progress) {
    const auto* super = indices(factor->super);
    trailing_part_.setZero(trailing, trailing);
    panels_.unknowns.reserve(factor->ssize);
    for (std::size_t s = 0; s < factor->nsuper; ++s) take(s, super[s], super[s + 1]);
    panels_.count = factor->xsize;
    // It is freed with the panels.
    panels_.values.reset(static_cast<double*>(std::exchange(factor->x, nullptr)));
  }

  Panels panels() && { return std::move(panels_); }
  const Eigen::MatrixXd& trailing_part() const { return trailing_part_; }

 private:
  void take(std::size_t number, SuiteSparse_long first, SuiteSparse_long end) {
    const auto *begins = indices(factor_->pi), *values_begin = indices(factor_->px);
    const auto* order = indices(factor_->Perm);
    const auto* rows = indices(factor_->s) + begins[number];
    const int size = static_cast<int>(begins[number + 1] - begins[number]);
    const int columns = static_cast<int>(end - first);
    // A supernode may reach from the leading unknowns to the trailing ones.
    const int pivots = static_cast<int>(std::clamp<SuiteSparse_long>(leading_ - first, 0, columns));
    const auto first_value = static_cast<std::size_t>(values_begin[number]);
    const double* values = static_cast<const double*>(factor_->x) + first_value;
    pace_.add(static_cast<std::size_t>(size));
    if (pivots > 0) {
      panels_.all.push_back({panels_.unknowns.size(), first_value, size, pivots});
      for (int k = 0; k < size; ++k) panels_.unknowns.push_back(static_cast<int>(order[rows[k]]));
    }
    for (int j = pivots; j < columns; ++j) {
      pace_.add(static_cast<std::size_t>(size - j));
      for (int i = j; i < size; ++i)
        trailing_part_(order[rows[i]] - leading_, first + j - leading_) =
            values[static_cast<std::ptrdiff_t>(j) * size + i];
    }
  }

  const SuiteSparse_long leading_;
  cholmod_factor* const factor_;
  Pace pace_;
  Panels panels_;
  Eigen::MatrixXd trailing_part_;
};

/// L Lᵀ less the diagonal.
Eigen::MatrixXd square_less(const std::vector<double>& diagonal, const Eigen::MatrixXd& l,
                            Progress& progress) {
  const int n = static_cast<int>(l.rows());
  Eigen::MatrixXd negative = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) negative(i, i) = diagonal[i];
  subtract_square(n, n, n, l.data(), n, negative.data(), n, progress);
  Pace pace(progress);
  for (int j = 0; j < n; ++j) {
    pace.add(static_cast<std::size_t>(n - j));
    negative.col(j).tail(n - j) *= -1;
    negative.row(j).tail(n - j) = negative.col(j).tail(n - j).transpose();
  }
  return negative;
}

/// The factor of K with `added` on the diagonal of its trailing unknowns.
Supernodes factored(const ElementSum& sum, const std::vector<double>& added, CholmodOrder by, Common& common,
                    Progress& progress) {
  const int trailing = static_cast<int>(added.size());
  const Sparse matrix = put_together(sum, added, common, progress);
  progress.check();
  Permutation order = by == CholmodOrder::given ? by_dissection(sum, trailing, progress)
                                                : by_minimum_degree(matrix.get(), trailing, common);
  progress.check();
  auto factor =
      owned<Supernodes>(cholmod_l_analyze_p(matrix.get(), order.data(), nullptr, 0, common.get()), common);
  progress.check();
  cholmod_l_factorize(matrix.get(), factor.get(), common.get());
  common.check();
  progress.check();
  return factor;
}

}  // namespace

// CHOLMOD factors whole matrices, but S may be singular, where contact alone holds the body. So K_CC is
// doubled on its diagonal D, and S = L_CC L_CCᵀ − D for the factor of that. D loses no digits that were
// there: S comes out of K_CC by subtraction in any case, with the rounding of K_CC, and D is as large.
// Another way would be to factor K_II alone, but then S takes a solve for each contact unknown, which is ten
// times the factorisation.
Factor cholmod(const ElementSum& matrix, int trailing, Progress& progress, CholmodOrder order) {
  progress.check();
  const int leading = matrix.size - trailing;
  const std::vector<double> diagonal = matrix.diagonal();
  if (!std::ranges::all_of(diagonal, [](double entry) { return entry > 0; })) throw NotPositiveDefinite();
  const std::vector<double> added(diagonal.begin() + leading, diagonal.end());
  Common common;
  const Supernodes factor = factored(matrix, added, order, common, progress);
  Taken taken(factor.get(), trailing, progress);
  Eigen::MatrixXd complement = square_less(added, taken.trailing_part(), progress);
  Panels panels = std::move(taken).panels();
  for (const Panels::Panel& panel : panels.all)
    require_stiffness(panels.unknowns_of(panel), panel.pivots, panels.columns(panel), diagonal);
  return {std::move(panels), std::move(complement)};
}

}  // namespace signorini
