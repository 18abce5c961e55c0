#include "certify/gap_bubble.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace signorini {
namespace {

/// Below this part of the displacement a difference is rounding.
constexpr double kSmall = 1e-12;

/// More than this is taken rather than that another cell is looked at.
constexpr double kNearEnough = 1.05;

/// Cells are not cut further: where g is smooth on them, and where it has a kink or jumps.
constexpr double kSmallestSmooth = 1. / 4096, kSmallestRough = 1e-9;

constexpr int kFirstCells = 16, kMostCells = 4000;

/// A quadratic function of s by its values at 0, ½, 1.
class Quadratic {
 public:
  explicit Quadratic(const std::array<double, 3>& values)
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

/// A part of the edge and the multiple that it takes at most.
struct Cell {
  double takes;
  double from, to;
  bool is_smooth;

  double middle() const { return (from + to) / 2; }
  bool can_be_cut() const { return to - from > (is_smooth ? kSmallestSmooth : kSmallestRough); }
  bool operator<(const Cell& other) const { return takes < other.takes; }
};

double bubble(double s) {
  return 4 * s * (1 - s);
}

/// With r = g − v_n: next to an end r ≥ s min r', and inside r by its values.
Cell cell(const Field& gap, const EdgeLine& line, const Quadratic& v, double from, double to) {
  const Interval s(from, to);
  const Series g = series_on(gap, line, s, 1);
  Cell own{0, from, to, is_known(g[1])};
  if (own.is_smooth && (from == 0 || to == 1)) {
    const Interval slope = g[1] - v.slope(s);
    own.takes = from == 0 ? -slope.lower() / (4 * (1 - to)) : slope.upper() / (4 * from);
    return own;
  }
  // By the values, or by the value in the middle and the slopes, whichever tells more.
  const double middle = own.middle();
  const Interval by_slopes = own.is_smooth ? line.value(gap, middle) + g[1] * (s - middle) : kAnything;
  const double lowest = std::max(g[0].lower(), by_slopes.lower()) - v(s).upper();
  if (!(lowest >= 0)) own.takes = -lowest / std::min(bubble(from), bubble(to));
  return own;
}

/// By cells, of which the one that asks for most is cut in two while that can change much.
double bubble_by_cells(const Field& gap, const EdgeLine& line, const Quadratic& v, double rounding) {
  std::priority_queue<Cell> open;
  for (int i = 0; i < kFirstCells; ++i)
    open.push(cell(gap, line, v, 1. * i / kFirstCells, (i + 1.) / kFirstCells));
  double at_least = 0;
  while (open.size() < kMostCells && open.top().can_be_cut()) {
    const Cell worst = open.top();
    const double middle = worst.middle();
    at_least = std::max(at_least, (v(middle) - line.value(gap, middle)) / bubble(middle));
    if (worst.takes <= kNearEnough * at_least + rounding) break;
    open.pop();
    open.push(cell(gap, line, v, worst.from, middle));
    open.push(cell(gap, line, v, middle, worst.to));
  }
  return std::max(0., open.top().takes);
}

}  // namespace

/// With r = g − v_n, r₀ ≥ 0 and r₁ ≥ 0 at the ends: if g is smooth, r = r₀ (1 − s) + r₁ s + s (1 − s) k with
/// k = −r[0, s, 1] ∈ −½ r'', and r + 4 b s (1 − s) ≥ 0 if −(k + 4 b) ≤ (√r₀ + √r₁)².
double bubble_below_gap(const Field& gap, const EdgeLine& line,
                        const std::array<double, 3>& normal_displacement, const std::array<double, 2>& room) {
  const Quadratic v(normal_displacement);
  const double rounding = kSmall * v.size();
  const double roots = std::pow(std::sqrt(std::max(0., room[0])) + std::sqrt(std::max(0., room[1])), 2);
  const Interval curvature = series_on(gap, line, Interval(0, 1), 2)[2];
  const double of_whole = (curvature.upper() - v.second() - roots) / 4;
  if (of_whole <= rounding) return std::max(0., of_whole);
  return std::min(bubble_by_cells(gap, line, v, rounding) + rounding, of_whole);
}

}  // namespace signorini
