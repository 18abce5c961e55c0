#include "certify/displacement/gap_bubble.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace signorini {
namespace {

/// Below this part of the displacement a difference is rounding.
constexpr double kBubbleRounding = 1e-12;

/// More than this is taken rather than that another cell is looked at.
constexpr double kNearEnough = 1.05;

/// Cells are not cut further: where g is smooth on them, and where it has a kink or jumps.
constexpr double kSmallestSmooth = 1. / 4096, kSmallestRough = 1e-9;

constexpr int kFirstCells = 16;

/// Bubbles are lower than so many times what v_n is above g, or the ends are lowered.
constexpr double kHigh = 4;

/// A quadratic function of s by its values at 0, ½, 1.
class EdgeQuadratic {
 public:
  explicit EdgeQuadratic(const std::array<double, 3>& values)
      : begin_(values[0]),
        end_(values[2]),
        second_(2 * (begin_ + end_) - 4 * values[1]),
        size_(std::abs(begin_) + std::abs(values[1]) + std::abs(end_)) {}

  /// Half the second derivative.
  double second() const { return second_; }
  double size() const { return size_; }
  double operator()(double s) const { return (1 - s) * begin_ + s * end_ - s * (1 - s) * second_; }
  Interval operator()(const Interval& s) const {
    const double middle = boost::numeric::median(s);
    const Interval way = s - middle;
    return (*this)(middle) + (end_ - begin_ - second_ + 2 * second_ * middle) * way + second_ * way * way;
  }
  Interval slope(const Interval& s) const { return (end_ - begin_ - second_) + 2 * second_ * s; }

 private:
  double begin_, end_, second_, size_;
};

/// A part of the edge.
struct Cell {
  double takes;  ///< of the bubble, at most
  double from, to;
  bool is_smooth;

  double middle() const { return (from + to) / 2; }
  bool can_be_cut() const { return to - from > (is_smooth ? kSmallestSmooth : kSmallestRough); }
  bool operator<(const Cell& other) const { return takes < other.takes; }
};

double bubble(double s) {
  return 4 * s * (1 - s);
}

/// With r = g − v_n: next to an end r ≥ r₀ + s min r', and everywhere by its values.
Cell cell(const BelowGap& of, const EdgeQuadratic& v, double from, double to) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const Interval s(from, to);
  const Series g = series_on(of.gap, of.line, s, 1);
  Cell own{none, from, to, is_known(g[1])};
  if (g[0].lower() - v(s).upper() >= 0) {
    own.takes = 0;
    return own;
  }
  const auto room = [&](int end) { return std::max(0., of.room[end]); };
  if (from == 0) {
    own.takes = -(g[1].lower() - v.slope(s).upper() + room(0) / to) / (4 * (1 - to));
    return own;
  }
  if (to == 1) {
    own.takes = (g[1].upper() - v.slope(s).lower() - room(1) / (1 - from)) / (4 * from);
    return own;
  }
  // By the values, or by the value in the middle and the slopes, whichever tells more.
  const double middle = own.middle();
  const Interval by_slopes = own.is_smooth ? of.line.value(of.gap, middle) + g[1] * (s - middle) : kAnything;
  const double lowest = std::max(g[0].lower(), by_slopes.lower()) - v(s).upper();
  own.takes = -lowest / std::min(bubble(from), bubble(to));
  return own;
}

/// By cells, of which the one that asks for most is cut in two while that can change much.
double bubble_by_cells(const BelowGap& of, const EdgeQuadratic& v, double rounding, CellBudget& budget) {
  std::priority_queue<Cell> open;
  for (int i = 0; i < kFirstCells; ++i) open.push(cell(of, v, 1. * i / kFirstCells, (i + 1.) / kFirstCells));
  double at_least = 0;
  for (; budget.cells > 0 && open.top().can_be_cut(); --budget.cells) {
    budget.look_around();
    const Cell worst = open.top();
    const double middle = worst.middle();
    at_least = std::max(at_least, (v(middle) - of.line.value(of.gap, middle)) / bubble(middle));
    if (worst.takes <= kNearEnough * at_least + rounding) break;
    open.pop();
    open.push(cell(of, v, worst.from, middle));
    open.push(cell(of, v, middle, worst.to));
  }
  return std::max(0., open.top().takes);
}

/// What v_n is above g at most.
double excess(const BelowGap& of, const EdgeQuadratic& v) {
  double most = 0;
  for (int i = 0; i < kFirstCells; ++i) {
    const Interval s(1. * i / kFirstCells, (i + 1.) / kFirstCells);
    most = std::max(most, v(s).upper() - series_on(of.gap, of.line, s, 0)[0].lower());
  }
  return most;
}

}  // namespace

/// With r = g − v_n, r₀ ≥ 0 and r₁ ≥ 0 at the ends: if g is smooth, r = r₀ (1 − s) + r₁ s + s (1 − s) k with
/// k = −r[0, s, 1] ∈ −½ r'', and r + 4 b s (1 − s) ≥ 0 if −(k + 4 b) ≤ (√r₀ + √r₁)².
double BelowGap::bubble(CellBudget& budget) const {
  const EdgeQuadratic v(normal_displacement);
  const double rounding = kBubbleRounding * v.size();
  const double roots = std::pow(std::sqrt(std::max(0., room[0])) + std::sqrt(std::max(0., room[1])), 2);
  const Interval curvature = series_on(gap, line, Interval(0, 1), 2)[2];
  const double of_whole = (curvature.upper() - v.second() - roots) / 4;
  if (of_whole <= rounding) return std::max(0., of_whole);
  return std::min(bubble_by_cells(*this, v, rounding, budget) + rounding, of_whole);
}

double BelowGap::level(CellBudget& budget) const {
  const double high = bubble(budget);
  if (high == 0) return 0;
  const double most = excess(*this, EdgeQuadratic(normal_displacement));
  if (!std::isfinite(most) || high <= kHigh * most) return 0;
  const auto lowered = [&](double by) {
    const auto& [a, b, c] = normal_displacement;
    return BelowGap{gap, line, {a - by, b - by, c - by}, {room[0] + by, room[1] + by}};
  };
  double best = most;
  for (double own = most / 2, least = most; own > most / 1024; own /= 2) {
    const double sum = own + lowered(own).bubble(budget);
    if (sum >= least) break;
    least = sum;
    best = own;
  }
  return best;
}

}  // namespace signorini
