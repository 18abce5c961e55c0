#include "formula/series.hpp"

#include <cmath>
#include <numbers>

namespace signorini {
namespace {

Series filled(const Series& a) {
  return Series(a.order());
}

Series scaled(const Series& a, double factor) {
  Series all = filled(a);
  for (int k = 0; k <= a.order(); ++k) all[k] = factor * a[k];
  return all;
}

Series sum(const Series& a, const Series& b, double sign) {
  Series all = filled(a);
  all[0] = signorini::sum(a[0], b[0], sign);
  for (int k = 1; k <= a.order(); ++k) all[k] = a[k] + sign * b[k];
  return all;
}

Series product(const Series& a, const Series& b) {
  Series all = filled(a);
  for (int k = 0; k <= a.order(); ++k)
    for (int j = 0; j <= k; ++j) all[k] += a[j] * b[k - j];
  return all;
}

/// The square keeps what the product of two equal intervals forgets: it is not negative.
Series square(const Series& a) {
  Series all = product(a, a);
  all[0] = boost::numeric::square(a[0]);
  return all;
}

bool holds_zero(const Interval& a) {
  return !(a.lower() > 0 || a.upper() < 0);
}

/// The recursions below divide by it.
Series with_values(const Series& a, const Interval& values) {
  return Series::rough(a.order(), values);
}

Series quotient(const Series& a, const Series& b) {
  if (holds_zero(b[0])) return with_values(a, signorini::quotient(a[0], b[0]));
  Series all = filled(a);
  for (int k = 0; k <= a.order(); ++k) {
    Interval rest = a[k];
    for (int j = 1; j <= k; ++j) rest -= b[j] * all[k - j];
    all[k] = rest / b[0];
  }
  return all;
}

/// From y' = a' / d and the values of y.
Series integral(const Series& a, const Series& d, const Interval& values) {
  if (holds_zero(d[0])) {
    Series rough = with_values(a, values);
    if (a.order() > 0) rough[1] = signorini::quotient(a[1], d[0]);
    return rough;
  }
  Series all(a.order(), values);
  for (int k = 1; k <= a.order(); ++k) {
    Interval rest = double(k) * a[k];
    for (int j = 1; j < k; ++j) rest -= double(j) * all[j] * d[k - j];
    all[k] = rest / (double(k) * d[0]);
  }
  return all;
}

/// By the Taylor coefficients φ_m(α) a^(α − m) of a^α, whose sums end for a whole exponent. Where a reaches 0
/// they may be infinite, of one sign.
Series power_by_taylor(const Series& a, double exponent, const Interval& values) {
  Series all(a.order(), values), beyond = a, beyond_to_m(a.order(), 1);
  beyond[0] = 0;
  Interval number = 1;
  for (int m = 1; m <= a.order() && m - 1 != exponent; ++m) {
    number = number * (exponent - m + 1) / double(m);
    beyond_to_m = product(beyond_to_m, beyond);
    const Interval own = number * signorini::power(a[0], exponent - m);
    for (int k = m; k <= a.order(); ++k) all[k] += own * beyond_to_m[k];
  }
  return all;
}

/// y a' α = a y'.
Series power(const Series& a, double exponent) {
  const Interval values = signorini::power(a[0], exponent);
  const bool is_whole = exponent >= 0 && exponent == std::floor(exponent);
  if (is_whole || holds_zero(a[0]))
    return is_known(values) ? power_by_taylor(a, exponent, values) : with_values(a, values);
  Series all(a.order(), values);
  for (int k = 1; k <= a.order(); ++k) {
    Interval rest = 0;
    for (int j = 1; j <= k; ++j) rest += (exponent * j - (k - j)) * a[j] * all[k - j];
    all[k] = rest / (double(k) * a[0]);
  }
  return all;
}

Series exponential(const Series& a) {
  Series all(a.order(), range(Operation::exp, a[0]));
  for (int k = 1; k <= a.order(); ++k) {
    Interval rest = 0;
    for (int j = 1; j <= k; ++j) rest += double(j) * a[j] * all[k - j];
    all[k] = rest / double(k);
  }
  return all;
}

Series logarithm(const Series& a) {
  const Interval values = range(Operation::log, a[0]);
  return a[0].lower() >= 0 ? integral(a, a, values) : with_values(a, values);
}

/// s' = a' c, c' = ∓ a' s: sine and cosine, or the hyperbolic ones.
struct Pair {
  Series sine, cosine;

  Pair(const Series& a, Operation of_sine, Operation of_cosine, double sign)
      : sine(a.order(), range(of_sine, a[0])), cosine(a.order(), range(of_cosine, a[0])) {
    for (int k = 1; k <= a.order(); ++k) {
      Interval of_s = 0, of_c = 0;
      for (int j = 1; j <= k; ++j) {
        of_s += double(j) * a[j] * cosine[k - j];
        of_c += double(j) * a[j] * sine[k - j];
      }
      sine[k] = of_s / double(k);
      cosine[k] = sign * of_c / double(k);
    }
  }
};

/// t' = a' (1 + sign t²): the tangent, or the hyperbolic one.
Series tangent(const Series& a, Operation operation, double sign) {
  const Interval values = range(operation, a[0]);
  if (!is_known(values)) return with_values(a, values);
  Series t(a.order(), values), slope(a.order());
  slope[0] = 1. + sign * boost::numeric::square(values);
  for (int k = 1; k <= a.order(); ++k) {
    Interval rest = 0;
    for (int j = 1; j <= k; ++j) rest += double(j) * a[j] * slope[k - j];
    t[k] = rest / double(k);
    for (int j = 0; j <= k; ++j) slope[k] += sign * t[j] * t[k - j];
  }
  return t;
}

Series plus(const Series& a, double constant) {
  Series all = a;
  all[0] = signorini::sum(a[0], constant, 1);
  return all;
}

/// y' = a' / √(c + sign a²)
Series inverse_of_root(const Series& a, double constant, double sign, const Interval& values) {
  const Series d = plus(scaled(square(a), sign), constant);
  if (!(d[0].lower() >= 0)) return with_values(a, values);
  return integral(a, power(d, 0.5), values);
}

}  // namespace

Series Series::line(int order, const Interval& at, const Interval& slope) {
  Series all(order, at);
  if (order > 0) all[1] = slope;
  return all;
}

Series Series::rough(int order, const Interval& values) {
  Series all(order, values);
  for (int k = 1; k <= order; ++k) all[k] = kAnything;
  return all;
}

Series constant_like(const Series& a, double value) {
  return Series(a.order(), value);
}

Series rough_like(const Series& a, const Interval& values) {
  return Series::rough(a.order(), values);
}

Series narrowed(Series a, const Interval& values) {
  a[0] = intersection(a[0], values);
  return a;
}

Series hull(const Series& a, const Series& b) {
  return Series::rough(a.order(), boost::numeric::hull(a[0], b[0]));
}

bool is_same(const Series& a, const Series& b) {
  const auto is_equal = [](const Interval& p, const Interval& q) {
    return p.lower() == q.lower() && p.upper() == q.upper();
  };
  for (int k = 0; k <= a.order(); ++k)
    if (!is_equal(a[k], b[k])) return false;
  return true;
}

Series smooth(Operation operation, const Series& a) {
  const Interval values = range(operation, a[0]);
  switch (operation) {
    case Operation::negate:
      return scaled(a, -1);
    case Operation::sqrt:
      return power(a, 0.5);
    case Operation::exp:
      return exponential(a);
    case Operation::ln:
    case Operation::log:
      return logarithm(a);
    case Operation::log2:
      return scaled(logarithm(a), 1 / std::numbers::ln2);
    case Operation::log10:
      return scaled(logarithm(a), 1 / std::numbers::ln10);
    case Operation::sin:
      return Pair(a, Operation::sin, Operation::cos, -1).sine;
    case Operation::cos:
      return Pair(a, Operation::sin, Operation::cos, -1).cosine;
    case Operation::sinh:
      return Pair(a, Operation::sinh, Operation::cosh, 1).sine;
    case Operation::cosh:
      return Pair(a, Operation::sinh, Operation::cosh, 1).cosine;
    case Operation::tan:
      return tangent(a, operation, 1);
    case Operation::tanh:
      return tangent(a, operation, -1);
    case Operation::asin:
      return inverse_of_root(a, 1, -1, values);
    case Operation::acos: {
      Series all = scaled(inverse_of_root(a, 1, -1, values), -1);
      all[0] = values;
      return all;
    }
    case Operation::atan:
      return integral(a, plus(square(a), 1), values);
    case Operation::asinh:
      return inverse_of_root(a, 1, 1, values);
    case Operation::acosh:
      return inverse_of_root(a, -1, 1, values);
    case Operation::atanh:
      return integral(a, plus(scaled(square(a), -1), 1), values);
    default:
      return with_values(a, kAnything);
  }
}

Series smooth(Operation operation, const Series& a, const Series& b) {
  switch (operation) {
    case Operation::add:
      return sum(a, b, 1);
    case Operation::subtract:
      return sum(a, b, -1);
    case Operation::multiply:
      return product(a, b);
    case Operation::divide:
      return quotient(a, b);
    case Operation::power: {
      const bool is_constant = b[0].lower() == b[0].upper() && [&] {
        for (int k = 1; k <= b.order(); ++k)
          if (largest(b[k]) != 0) return false;
        return true;
      }();
      if (is_constant) return power(a, b[0].lower());
      if (!(a[0].lower() > 0)) return with_values(a, signorini::power(a[0], b[0]));
      return exponential(product(b, logarithm(a)));
    }
    case Operation::atan2: {
      // φ' = (x y' − y x') / (x² + y²), here for (y, x) = (a, b).
      const Interval values = angle(a[0], b[0]);
      const Series square_of_distance = sum(square(a), square(b), 1);
      const bool crosses_cut = b[0].lower() < 0 && a[0].lower() < 0 && a[0].upper() > 0;
      if (crosses_cut || holds_zero(square_of_distance[0])) return with_values(a, values);
      Series all(a.order(), values);
      for (int k = 1; k <= a.order(); ++k) {
        Interval rest = 0;
        for (int j = 1; j <= k; ++j) rest += double(j) * (b[k - j] * a[j] - a[k - j] * b[j]);
        for (int j = 1; j < k; ++j) rest -= double(j) * all[j] * square_of_distance[k - j];
        all[k] = rest / (double(k) * square_of_distance[0]);
      }
      return all;
    }
    default:
      return with_values(a, kAnything);
  }
}

bool has_slope(const Series& a, double rounding) {
  if (a.order() == 0 || !is_known(a[1])) return false;
  return a[1].lower() > rounding || a[1].upper() < -rounding;
}

}  // namespace signorini
