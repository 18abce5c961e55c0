#include "formula/taylor_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formula/series.hpp"

namespace signorini {
namespace {

constexpr int kDegree = TaylorModel::kDegree, kSize = TaylorModel::kSize;

constexpr int first_of(int degree) {
  return degree * (degree + 1) / 2;
}

/// The powers of u and v of the monomials, their degrees, and what they are at most on the triangle.
struct Monomials {
  std::array<int, kSize> u{}, v{}, degree{};
  std::array<double, kSize> largest{};
  /// number[i][j]: of the product of two, -1 above the degree.
  std::array<std::array<int, kSize>, kSize> number{};

  Monomials() {
    int next = 0;
    for (int k = 0; k <= kDegree; ++k)
      for (int j = 0; j <= k; ++j, ++next) {
        u[next] = k - j;
        v[next] = j;
        degree[next] = k;
      }
    for (int i = 0; i < kSize; ++i) {
      largest[i] = bound(u[i], v[i]);
      for (int j = 0; j < kSize; ++j) {
        const int k = degree[i] + degree[j];
        number[i][j] = k > kDegree ? -1 : first_of(k) + v[i] + v[j];
      }
    }
  }

  /// |u^a v^b| has no maximum inside but at a zero of its gradient, so that it is largest on the boundary;
  /// there it is u^a v^b on three lines. The sampled maximum misses less than the margin.
  static double bound(int a, int b) {
    constexpr int samples = 300;
    double most = 0;
    for (int i = 0; i <= samples; ++i) {
      const double s = -1. / 3 + 1. * i / samples;
      for (const auto& [u, v] : {std::pair{s, -1. / 3}, {-1. / 3, s}, {s, 1. / 3 - s}})
        most = std::max(most, std::abs(std::pow(u, a) * std::pow(v, b)));
    }
    return most * (1 + 1e-4);
  }
};

const Monomials& monomials() {
  static const Monomials all;
  return all;
}

using Sizes = std::array<double, kDegree + 1>;

Sizes sizes(const std::array<double, kSize>& c) {
  const Monomials& m = monomials();
  Sizes sizes{};
  for (int i = 0; i < kSize; ++i) sizes[m.degree[i]] += std::abs(c[i]) * m.largest[i];
  return sizes;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double sum_of(const Sizes& sizes) {
  double sum = 0;
  for (const double own : sizes) sum += own;
  return sum;
}

/// A bound that is no number bounds nothing.
double bounded(double bound) {
  return std::isnan(bound) ? kInfinity : bound;
}

}  // namespace

TaylorModel::TaylorModel(double constant) : values_(constant) {
  c_[0] = constant;
}

TaylorModel TaylorModel::linear(const std::array<double, 3>& at_corners) {
  TaylorModel model;
  const auto& [a, b, c] = at_corners;
  model.c_[0] = (a + b + c) / 3;
  model.c_[1] = b - a;
  model.c_[2] = c - a;
  model.values_ = {std::min({a, b, c}), std::max({a, b, c})};
  return model;
}

TaylorModel TaylorModel::rough(const Interval& values) {
  TaylorModel model;
  model.values_ = values;
  const bool known = is_known(values);
  model.c_[0] = known ? (values.lower() + values.upper()) / 2 : 0;
  model.remainder_ = known ? (values.upper() - values.lower()) / 2 : kInfinity;
  return model;
}

double TaylorModel::at(double first, double second) const {
  const double u = first - 1. / 3, v = second - 1. / 3;
  std::array<double, kDegree + 1> pu{1}, pv{1};
  for (int k = 1; k <= kDegree; ++k) {
    pu[k] = pu[k - 1] * u;
    pv[k] = pv[k - 1] * v;
  }
  double sum = 0;
  for (int i = 0; i < kSize; ++i) sum += c_[i] * pu[monomials().u[i]] * pv[monomials().v[i]];
  return sum;
}

int TaylorModel::degree() const {
  for (int i = kSize; i-- > 1;)
    if (c_[i] != 0) return monomials().degree[i];
  return 0;
}

/// The values at the corners of all up to degree 2. On edge e, t ∈ [0, 1], that is linear but for −b_e t (1 −
/// t), b_e half its second derivative, and on the triangle but for −Σ b_e λ_i λ_j; the λ_i λ_j are at most ¼
/// each and add up to at most ⅓.
TaylorModel::LinearPart TaylorModel::linear_part() const {
  const auto at = [this](double u, double v) {
    return c_[0] + c_[1] * u + c_[2] * v + c_[3] * u * u + c_[4] * u * v + c_[5] * v * v;
  };
  const auto most = [](double a, double b, double c) {
    const double sum = std::max(0., a) + std::max(0., b) + std::max(0., c);
    return std::min(sum / 4, std::max({0., a, b, c}) / 3);
  };
  const Sizes by_degree = sizes(c_);
  double rest = remainder_;
  for (int k = 3; k <= kDegree; ++k) rest += by_degree[k];
  const double first = c_[3] - c_[4] + c_[5], second = c_[5], third = c_[3];
  return {{at(-1. / 3, -1. / 3), at(2. / 3, -1. / 3), at(-1. / 3, 2. / 3)},
          rest + most(first, second, third),
          rest + most(-first, -second, -third)};
}

void TaylorModel::narrow() {
  remainder_ = bounded(remainder_);
  const LinearPart part = linear_part();
  const auto [least, most] = std::ranges::minmax(part.at_corners);
  const double lower = least - part.below, upper = most + part.above;
  if (!std::isfinite(lower) || !std::isfinite(upper)) return;
  values_ = intersection(Interval(lower, upper), values_);
  // Where the polynomial tells less than the values by themselves, they stand alone.
  if (remainder_ > 0 && 2 * remainder_ >= values_.upper() - values_.lower() && is_known(values_))
    *this = rough(values_);
}

TaylorModel sum(const TaylorModel& a, const TaylorModel& b, double sign) {
  TaylorModel all;
  for (int i = 0; i < kSize; ++i) all.c_[i] = a.c_[i] + sign * b.c_[i];
  all.remainder_ = a.remainder_ + b.remainder_;
  all.values_ = signorini::sum(a.values_, b.values_, sign);
  all.narrow();
  return all;
}

TaylorModel product(const TaylorModel& a, const TaylorModel& b) {
  const Monomials& m = monomials();
  TaylorModel all;
  const int last_a = first_of(a.degree() + 1), last_b = first_of(b.degree() + 1);
  for (int i = 0; i < last_a; ++i) {
    if (a.c_[i] == 0) continue;
    for (int j = 0; j < std::min(last_b, first_of(kDegree - m.degree[i] + 1)); ++j)
      all.c_[m.number[i][j]] += a.c_[i] * b.c_[j];
  }
  const Sizes of_a = sizes(a.c_), of_b = sizes(b.c_);
  double cut = 0;
  for (int k = 1; k <= kDegree; ++k)
    for (int l = kDegree + 1 - k; l <= kDegree; ++l) cut += of_a[k] * of_b[l];
  if (a.remainder_ > 0) cut += a.remainder_ * (sum_of(of_b) + b.remainder_);
  if (b.remainder_ > 0) cut += b.remainder_ * sum_of(of_a);
  all.remainder_ = cut;
  all.values_ = &a == &b ? boost::numeric::square(a.values_) : a.values_ * b.values_;
  all.narrow();
  return all;
}

/// φ(c + δ) = Σ φ_k δ^k + φ_{n+1}(ξ) δ^{n+1} with the Taylor coefficients φ_k in c and ξ between c and the
/// values.
TaylorModel composed(Operation operation, const TaylorModel& a, double exponent) {
  const auto coefficients = [&](int order, const Interval& at) {
    const Series line = Series::line(order, at, 1);
    return operation == Operation::power ? smooth(operation, line, Series(order, exponent))
                                         : smooth(operation, line);
  };
  const Interval values =
      operation == Operation::power ? power(a.values_, exponent) : range(operation, a.values_);
  const double center = a.c_[0];
  if (a.degree() == 0 && a.remainder_ == 0) {
    TaylorModel constant(coefficients(0, center)[0].lower());
    return is_known(range(constant)) ? constant : TaylorModel::rough(kAnything);
  }
  const Series at_center = coefficients(kDegree, center),
               rest = coefficients(kDegree + 1, boost::numeric::hull(a.values_, center));
  const double distance =
      std::max(std::abs(a.values_.upper() - center), std::abs(a.values_.lower() - center));
  const double last = largest(rest[kDegree + 1]) * std::pow(distance, kDegree + 1);
  if (!std::isfinite(last) || !is_known(at_center[kDegree])) return TaylorModel::rough(values);
  TaylorModel delta = a;
  delta.c_[0] = 0;
  delta.values_ = a.values_ - center;
  TaylorModel all(at_center[kDegree].lower());
  for (int k = kDegree; k-- > 0;) {
    all = product(all, delta);
    all.c_[0] += at_center[k].lower();
    all.values_ += at_center[k].lower();
  }
  all.remainder_ += last;
  all.values_ = values;
  all.narrow();
  return all;
}

TaylorModel narrowed(TaylorModel a, const Interval& values) {
  a.values_ = intersection(a.values_, values);
  a.narrow();
  return a;
}

/// The mean of both polynomials, which differ from it by half their difference.
TaylorModel hull(const TaylorModel& a, const TaylorModel& b) {
  TaylorModel mean, rest;
  for (int i = 0; i < kSize; ++i) {
    mean.c_[i] = (a.c_[i] + b.c_[i]) / 2;
    rest.c_[i] = (a.c_[i] - b.c_[i]) / 2;
  }
  rest.values_ = kAnything;
  rest.narrow();
  mean.remainder_ = largest(rest.values_) + std::max(a.remainder_, b.remainder_);
  mean.values_ = boost::numeric::hull(a.values_, b.values_);
  mean.narrow();
  return mean;
}

bool is_same(const TaylorModel& a, const TaylorModel& b) {
  return a.coefficients() == b.coefficients() && a.remainder() == b.remainder() &&
         range(a).lower() == range(b).lower() && range(a).upper() == range(b).upper();
}

TaylorModel smooth(Operation operation, const TaylorModel& a) {
  if (operation == Operation::negate) return sum(TaylorModel(0.), a, -1);
  return composed(operation, a, 1);
}

TaylorModel smooth(Operation operation, const TaylorModel& a, const TaylorModel& b) {
  const bool is_constant = b.degree() == 0 && b.remainder() == 0;
  switch (operation) {
    case Operation::add:
      return sum(a, b, 1);
    case Operation::subtract:
      return sum(a, b, -1);
    case Operation::multiply:
      return product(a, b);
    case Operation::divide:
      return product(a, composed(Operation::power, b, -1));
    case Operation::power:
      if (is_constant && b.coefficients()[0] == 2) return product(a, a);
      if (is_constant) return composed(operation, a, b.coefficients()[0]);
      if (!(a.values().lower() > 0)) return TaylorModel::rough(power(a.values(), b.values()));
      return composed(Operation::exp, product(b, composed(Operation::log, a, 1)), 1);
    case Operation::atan2: {
      // arctan of the quotient, turned such that it is away from the cut; the same as an angle at every
      // point.
      const Interval values = angle(a.values(), b.values());
      TaylorModel all = TaylorModel::rough(values);
      const Interval &y = a.values(), &x = b.values();
      if (x.lower() > 0)
        all = composed(Operation::atan, smooth(Operation::divide, a, b), 1);
      else if (y.lower() > 0)
        all = sum(TaylorModel(std::asin(1.)), composed(Operation::atan, smooth(Operation::divide, b, a), 1),
                  -1);
      else if (y.upper() < 0)
        all = sum(TaylorModel(-std::asin(1.)), composed(Operation::atan, smooth(Operation::divide, b, a), 1),
                  -1);
      else if (x.upper() < 0 && (y.lower() >= 0 || y.upper() <= 0))
        all = sum(TaylorModel((y.lower() >= 0 ? 2 : -2) * std::asin(1.)),
                  composed(Operation::atan, smooth(Operation::divide, a, b), 1), 1);
      return all;
    }
    default:
      return TaylorModel::rough(kAnything);
  }
}

bool has_slope(const TaylorModel& a, double rounding) {
  // A polynomial of degree 4 whose values are so small beside those of a linear one has a smaller slope, too.
  constexpr double nearly_linear = 5e-3, sliver = 1e-3;
  const TaylorModel::LinearPart part = a.linear_part();
  const auto [least, most] = std::ranges::minmax(part.at_corners);
  const double rise = most - least;
  return part.below + part.above <= nearly_linear * rise && rounding <= sliver * rise;
}

}  // namespace signorini
