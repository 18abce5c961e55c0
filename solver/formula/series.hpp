#pragma once

#include <array>

#include "formula/interval.hpp"

namespace signorini {

/// The Taylor coefficients f^(k)/k!, k = 0 … order, of a function of one variable, each enclosed for all
/// points of an interval (which may be a single point): the arithmetic of automatic differentiation. Where
/// the function is not smooth its values are enclosed all the same, and its derivatives are anything.
class Series {
 public:
  static constexpr int kMost = 10;

  /// A constant.
  explicit Series(int order = 0, const Interval& value = {}) : order_(order) { coefficients_[0] = value; }

  /// at + slope · δ.
  static Series line(int order, const Interval& at, const Interval& slope);
  /// Only the values are known.
  static Series rough(int order, const Interval& values);

  int order() const { return order_; }
  const Interval& operator[](int k) const { return coefficients_[k]; }
  Interval& operator[](int k) { return coefficients_[k]; }

 private:
  int order_;
  std::array<Interval, kMost + 1> coefficients_{};
};

inline const Interval& range(const Series& a) {
  return a[0];
}

/// A constant, and what is known by its values only, to the order of a.
Series constant_like(const Series& a, double value);
Series rough_like(const Series& a, const Interval& values);

/// Of the operations that are smooth where they are defined: neither comparisons nor what has kinks.
Series smooth(Operation operation, const Series& a);
Series smooth(Operation operation, const Series& a, const Series& b);

/// With values that are known to lie in an interval besides.
Series narrowed(Series a, const Interval& values);

/// What encloses both.
Series hull(const Series& a, const Series& b);

bool is_same(const Series& a, const Series& b);

/// Its derivative has one sign and is no rounding.
bool has_slope(const Series& a, double rounding);

}  // namespace signorini
