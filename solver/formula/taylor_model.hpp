#pragma once

#include <array>

#include "formula/interval.hpp"

namespace signorini {

/// A function on a triangle as a polynomial of degree 4 and a bound of what it is off by (Makino, Berz 2003).
/// The variables (u, v) are the reference coordinates less those of the centroid: u, v ∈ [−1/3, 2/3], u + v ≤
/// 1/3.
class TaylorModel {
 public:
  static constexpr int kDegree = 4, kSize = (kDegree + 1) * (kDegree + 2) / 2;

  TaylorModel() = default;
  explicit TaylorModel(double constant);
  /// The linear function with these values at the corners.
  static TaylorModel linear(const std::array<double, 3>& at_corners);
  /// Only the values are known.
  static TaylorModel rough(const Interval& values);

  /// Coefficients by degree: 1; u, v; u², uv, v²; …
  const std::array<double, kSize>& coefficients() const { return c_; }
  /// What |f − polynomial| is at most.
  double remainder() const { return remainder_; }
  const Interval& values() const { return values_; }

  /// The polynomial at a point of the reference triangle.
  double at(double first, double second) const;

  /// No coefficient of a degree above this is but 0; 0 if there is none at all.
  int degree() const;
  /// A linear function by its values at the corners, and what the model lies below and above it at most.
  struct LinearPart {
    std::array<double, 3> at_corners;
    double below, above;
  };
  LinearPart linear_part() const;

  friend TaylorModel sum(const TaylorModel& a, const TaylorModel& b, double sign);
  friend TaylorModel product(const TaylorModel& a, const TaylorModel& b);
  friend TaylorModel composed(Operation operation, const TaylorModel& a, double exponent);
  friend TaylorModel narrowed(TaylorModel a, const Interval& values);
  friend TaylorModel hull(const TaylorModel& a, const TaylorModel& b);

 private:
  /// Takes the values that polynomial and remainder leave into account.
  void narrow();

  std::array<double, kSize> c_{};
  double remainder_ = 0;
  Interval values_ = 0.;
};

inline const Interval& range(const TaylorModel& a) {
  return a.values();
}

inline TaylorModel constant_like(const TaylorModel&, double value) {
  return TaylorModel(value);
}
inline TaylorModel rough_like(const TaylorModel&, const Interval& values) {
  return TaylorModel::rough(values);
}

/// Of the operations that are smooth where they are defined: neither comparisons nor what has kinks.
TaylorModel smooth(Operation operation, const TaylorModel& a);
TaylorModel smooth(Operation operation, const TaylorModel& a, const TaylorModel& b);

/// With values that are known to lie in an interval besides.
TaylorModel narrowed(TaylorModel a, const Interval& values);

/// What encloses both.
TaylorModel hull(const TaylorModel& a, const TaylorModel& b);

bool is_same(const TaylorModel& a, const TaylorModel& b);

/// So nearly linear that it is less than rounding on a sliver at most.
bool has_slope(const TaylorModel& a, double rounding);

}  // namespace signorini
