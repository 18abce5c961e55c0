#include "system/multifrontal.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include <cblas.h>

#include "progress/pace.hpp"
#include "system/dissection.hpp"
#include "system/elimination_in_blocks.hpp"
#include "system/in_strips.hpp"
#include "system/lower_triangle.hpp"
#include "system/repeated_pieces.hpp"

namespace signorini {
namespace {

/// Fronts up to this size are factored without BLAS.
constexpr int kSmall = 24;

/// Matrices that are taken and released last in, first out.
class Stack {
 public:
  explicit Stack(std::size_t capacity) : values_(allocate_numbers(capacity)) {}

  double* push(std::size_t size) {
    double* top = values_.get() + used_;
    used_ += size;
    return top;
  }
  void pop(std::size_t size) { used_ -= size; }
  double* top() { return values_.get() + used_; }

 private:
  Numbers values_;
  std::size_t used_ = 0;
};

/// The numerical part, which fills the panels of the original pieces. What a piece leaves is a symmetric
/// matrix of its front's rest, kept until the pieces that it is a half of have taken it in. Mostly that is
/// one. Its own is made while those of its halves still stand, so pieces of odd and of even depth use two
/// stacks, and each is last in, first out. What several take in stands by itself.
class FrontElimination {
 public:
  FrontElimination(const Dissection& order, const RepeatedPieces& repeated, double* panels,
                   const ElementSum& matrix, Progress& progress)
      : order_(order),
        repeated_(repeated),
        next_panel_(panels),
        matrix_(matrix),
        progress_(progress),
        pace_(progress),
        position_(matrix.size),
        stacks_(make_stacks()),
        diagonal_(matrix.diagonal()) {
    for_each_original([this](int piece) { eliminate(piece); });
  }

  /// What the whole leaves, in the order of the trailing unknowns. Columns are filled one after the other:
  /// gigabytes that are touched for the first time come page by page.
  Eigen::MatrixXd complement() {
    constexpr int whole = 1, block = LowerTriangle::kStrip;
    const Dissection::Front front = order_.front(whole);
    const int n = front.rest();
    stack(whole).pop(rest_size(front));
    const double* const values = stack(whole).top();
    const LowerTriangle lower(n);
    Eigen::MatrixXd all = unset_square(n);
    for (int j = 0; j < n; j += block) {
      const int columns = lower.columns_of_strip(j), below = n - j - columns;
      pace_.add(static_cast<std::size_t>(n) * columns);
      const Eigen::Map<const Eigen::MatrixXd> strip(values + lower.begin(j), n - j, columns);
      for (int i = 0; i < j; i += block)
        all.block(i, j, block, columns) = all.block(j, i, columns, block).transpose();
      all.block(j, j, columns, columns) = strip.topRows(columns).selfadjointView<Eigen::Lower>();
      all.block(j + columns, j, below, columns) = strip.bottomRows(below);
    }
    return all;
  }

 private:
  static std::size_t rest_size(const Dissection::Front& front) { return LowerTriangle(front.rest()).size(); }
  static int depth_parity(int piece) { return std::bit_width(static_cast<unsigned>(piece)) % 2; }
  Stack& stack(int piece) { return stacks_[depth_parity(piece)]; }

  template <typename Visit>
  void for_each_original(Visit visit) const {
    order_.for_each_piece([this](int piece) { return repeated_.is_original(piece); }, visit);
  }
  /// Whether what it leaves is taken in more than once.
  bool is_shared(int original) const { return repeated_.uses(original) > 1; }

  std::array<Stack, 2> make_stacks() const {
    std::array<std::size_t, 2> used{}, most{};
    for_each_original([&](int piece) {
      const int own = depth_parity(piece);
      if (!is_shared(piece)) used[own] += rest_size(order_.front(piece));
      most[own] = std::max(most[own], used[own]);
      if (order_.is_leaf(piece)) return;
      for (const int half : {2 * piece, 2 * piece + 1})
        if (!is_shared(repeated_.original(half))) used[1 - own] -= rest_size(order_.front(half));
    });
    return {Stack(most[0]), Stack(most[1])};
  }

  /// Where what a piece leaves is to stand.
  double* make_rest(int piece, std::size_t size) {
    if (!is_shared(piece)) return stack(piece).push(size);
    return shared_.emplace(piece, Shared{allocate_numbers(size), repeated_.uses(piece)})
        .first->second.values.get();
  }

  void eliminate(int piece) {
    progress_.check();
    const Dissection::Front front = order_.front(piece);
    const Target target{next_panel_, make_rest(piece, rest_size(front)), front.size(), front.pivots,
                        LowerTriangle(front.rest())};
    for (int k = 0; k < front.size(); ++k) {
      pace_.add(static_cast<std::size_t>(front.size() - k));
      std::fill_n(target[k] + k, front.size() - k, 0.);
    }
    for (int k = 0; k < front.size(); ++k) position_[front.unknowns[k]] = k;
    if (order_.is_leaf(piece)) {
      for (const int element : order_.elements(piece)) add_element(element, target);
    } else {
      // The second half lies on top of the stack.
      add_half(2 * piece + 1, target);
      add_half(2 * piece, target);
    }
    factor(target);
    require_stiffness(front.unknowns, front.pivots, target.columns, diagonal_);
    next_panel_ += static_cast<std::ptrdiff_t>(front.size()) * front.pivots;
  }

  /// A front while it is assembled and factored; of its symmetric matrix the lower triangle is kept, the
  /// columns of the pivots apart from the rest.
  struct Target {
    double* columns;
    double* rest;
    int size, pivots;
    LowerTriangle of_rest;

    /// A column, to be indexed with rows from the diagonal on.
    double* operator[](int j) const {
      return j < pivots ? columns + static_cast<std::ptrdiff_t>(j) * size
                        : of_rest.column(rest, j - pivots) - pivots;
    }
  };

  void add_element(int element, const Target& target) {
    const auto unknowns = matrix_.unknowns_of(element);
    const double* values = matrix_.matrix(element);
    const int n = matrix_.per_element;
    for (int j = 0; j < n; ++j) {
      if (unknowns[j] < 0) continue;
      const int column = position_[unknowns[j]];
      for (int i = 0; i < n; ++i) {
        // Two rows of an element may be one unknown; then both orders of the pair fall on the diagonal.
        if (unknowns[i] >= 0 && position_[unknowns[i]] >= column)
          target[column][position_[unknowns[i]]] += values[j * n + i];
      }
    }
  }

  void add_half(int half, const Target& target) {
    const int original = repeated_.original(half);
    if (!is_shared(original)) {
      stack(half).pop(rest_size(order_.front(half)));
      add_rest(half, stack(half).top(), target);
      return;
    }
    const auto shared = shared_.find(original);
    add_rest(half, shared->second.values.get(), target);
    if (--shared->second.uses_left == 0) shared_.erase(shared);
  }

  void add_rest(int half, const double* values, const Target& target) {
    const Dissection::Front front = order_.front(half);
    const std::span<const int> unknowns = front.remaining();
    const int n = front.rest();
    const LowerTriangle lower(n);
    places_.resize(n);
    for (int k = 0; k < n; ++k) places_[k] = position_[unknowns[k]];
    for (int j = 0; j < n; ++j) {
      double* column = target[places_[j]];
      const double* own = lower.column(values, j);
      pace_.add(static_cast<std::size_t>(n));
      for (int i = j; i < n; ++i) column[places_[i]] += own[i];
    }
  }

  void factor(const Target& front) {
    const int m = front.size, p = front.pivots;
    if (m <= kSmall) return factor_small(front);
    const auto update_rest = [&](int begin, int width) {
      constexpr int columns = LowerTriangle::kStrip;
      const int rest = m - p;
      in_strips((rest + columns - 1) / columns, static_cast<double>(rest) * rest * width, progress_,
                [&](int strip, Progress& its) {
                  const int j = strip * columns, rows = front.of_rest.rows_of_strip(j);
                  subtract_square(rows, front.of_rest.columns_of_strip(j), width, front[begin] + p + j, m,
                                  front.rest + front.of_rest.begin(j), rows, its);
                });
    };
    if (!eliminate_in_blocks(m, p, front.columns, m, progress_, update_rest)) throw NotPositiveDefinite();
  }

  /// The same column by column: a call of BLAS takes longer than a small front.
  void factor_small(const Target& front) {
    for (int k = 0; k < front.pivots; ++k) {
      double* column = front[k];
      if (!(column[k] > 0)) throw NotPositiveDefinite();
      const double pivot = std::sqrt(column[k]);
      column[k] = pivot;
      for (int i = k + 1; i < front.size; ++i) column[i] /= pivot;
      for (int j = k + 1; j < front.size; ++j) {
        double* other = front[j];
        const double factor = column[j];
        for (int i = j; i < front.size; ++i) other[i] -= factor * column[i];
      }
    }
  }

  struct Shared {
    Numbers values;
    int uses_left;
  };

  const Dissection& order_;
  const RepeatedPieces& repeated_;
  double* next_panel_;
  const ElementSum& matrix_;
  Progress& progress_;
  Pace pace_;
  std::vector<int> position_;  ///< in the present front, of each of its unknowns
  std::vector<int> places_;
  std::array<Stack, 2> stacks_;
  std::unordered_map<int, Shared> shared_;  ///< what originals have left that others still take in
  std::vector<double> diagonal_;            ///< of the matrix
};

}  // namespace

Factor multifrontal(const ElementSum& matrix, int trailing, Progress& progress) {
  Dissection order(matrix, trailing, progress);
  const RepeatedPieces repeated(order, matrix, progress);
  Panels panels;
  int pivots = 0;
  std::vector<std::size_t> first_value(order.pieces());
  order.for_each_piece([&](int piece) {
    const Dissection::Front front = order.front(piece);
    pivots += front.pivots;
    if (front.pivots == 0) return;
    first_value[piece] = panels.count;
    if (repeated.is_original(piece))
      panels.count += static_cast<std::size_t>(front.size()) * front.pivots;
    else
      first_value[piece] = first_value[repeated.original(piece)];
    panels.all.push_back({order.first_unknown(piece), first_value[piece], front.size(), front.pivots});
  });
  const bool rows_of_zeros = pivots != matrix.size - trailing || order.front(1).rest() != trailing;
  if (rows_of_zeros) throw NotPositiveDefinite();
  panels.values = allocate_numbers(panels.count);
  Eigen::MatrixXd complement =
      FrontElimination(order, repeated, panels.values.get(), matrix, progress).complement();
  panels.unknowns = order.take_unknowns();
  return {std::move(panels), std::move(complement), order.tree()};
}

}  // namespace signorini
