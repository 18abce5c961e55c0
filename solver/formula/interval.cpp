#include "formula/interval.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace signorini {
namespace {

template <typename Function>
Interval rising(const Interval& a, const Function& f) {
  const double lower = f(a.lower()), upper = f(a.upper());
  return std::isnan(lower) || std::isnan(upper) ? kAnything : Interval(lower, upper);
}

template <typename Function>
Interval falling(const Interval& a, const Function& f) {
  return -rising(a, [&](double x) { return -f(x); });
}

/// Where a function begins: an end that only rounding puts before it.
Interval from(double begin, const Interval& a, double scale) {
  const bool is_rounding =
      a.lower() < begin && a.lower() >= begin - kEnclosureRounding * scale && a.upper() >= begin;
  return is_rounding ? Interval(begin, a.upper()) : a;
}

Interval between(double begin, double end, const Interval& a) {
  const Interval above = from(begin, a, end - begin);
  return -from(-end, -above, end - begin);
}

template <typename Function>
Interval rising_from(double begin, const Interval& a, const Function& f) {
  const Interval inside = from(begin, a, largest(a));
  return inside.lower() < begin ? kAnything : rising(inside, f);
}

/// 1 / a.
Interval inverse(const Interval& a) {
  if (a.lower() > 0 || a.upper() < 0) return 1. / a;
  if (a.lower() == 0 && a.upper() > 0) return {1 / a.upper(), kAnything.upper()};
  if (a.upper() == 0 && a.lower() < 0) return {kAnything.lower(), 1 / a.lower()};
  return kAnything;
}

Interval sine(const Interval& a) {
  constexpr double turn = 2 * std::numbers::pi;
  if (!(a.upper() - a.lower() < turn)) return {-1, 1};
  const double s = std::sin(a.lower()), e = std::sin(a.upper());
  // A crest lies at π/2 + 2πk, a trough at −π/2 + 2πk.
  const auto meets = [&](double phase) {
    return std::ceil((a.lower() - phase) / turn) * turn + phase <= a.upper();
  };
  return {meets(-turn / 4) ? -1 : std::min(s, e), meets(turn / 4) ? 1 : std::max(s, e)};
}

}  // namespace

Interval intersection(const Interval& a, const Interval& b) {
  const double begin = std::max(a.lower(), b.lower()), end = std::min(a.upper(), b.upper());
  return {std::min(begin, end), std::max(begin, end)};
}

Interval sum(const Interval& a, const Interval& b, double sign) {
  const Interval other = sign * b, all = a + other;
  const auto is_rounding = [](double end, double one, double two) {
    return std::isfinite(end) && std::abs(end) <= kEnclosureRounding * (std::abs(one) + std::abs(two));
  };
  if (all.lower() > 0 || all.upper() < 0) return all;
  return {is_rounding(all.lower(), a.lower(), other.lower()) ? 0 : all.lower(),
          is_rounding(all.upper(), a.upper(), other.upper()) ? 0 : all.upper()};
}

Interval quotient(const Interval& a, const Interval& b) {
  return a * inverse(b);
}

Interval range(Operation operation, const Interval& a) {
  switch (operation) {
    case Operation::negate:
      return -a;
    case Operation::abs:
      return boost::numeric::abs(a);
    case Operation::sqrt:
      return rising_from(0, a, [](double x) { return std::sqrt(x); });
    case Operation::exp:
      return rising(a, [](double x) { return std::exp(x); });
    case Operation::ln:
    case Operation::log:
      return rising_from(0, a, [](double x) { return std::log(x); });
    case Operation::log2:
      return rising_from(0, a, [](double x) { return std::log2(x); });
    case Operation::log10:
      return rising_from(0, a, [](double x) { return std::log10(x); });
    case Operation::sin:
      return sine(a);
    case Operation::cos:
      return sine(a + std::numbers::pi / 2);
    case Operation::tan: {
      const double k = std::floor(a.lower() / std::numbers::pi + 0.5);
      const bool is_one_branch = a.upper() < (k + 0.5) * std::numbers::pi;
      return is_one_branch ? rising(a, [](double x) { return std::tan(x); }) : kAnything;
    }
    case Operation::asin:
      return rising(between(-1, 1, a), [](double x) { return std::asin(x); });
    case Operation::acos:
      return falling(between(-1, 1, a), [](double x) { return std::acos(x); });
    case Operation::atan:
      return rising(a, [](double x) { return std::atan(x); });
    case Operation::sinh:
      return rising(a, [](double x) { return std::sinh(x); });
    case Operation::cosh:
      return rising(boost::numeric::abs(a), [](double x) { return std::cosh(x); });
    case Operation::tanh:
      return rising(a, [](double x) { return std::tanh(x); });
    case Operation::asinh:
      return rising(a, [](double x) { return std::asinh(x); });
    case Operation::acosh:
      return rising_from(1, a, [](double x) { return std::acosh(x); });
    case Operation::atanh:
      return rising(between(-1, 1, a), [](double x) { return std::atanh(x); });
    default:
      return kAnything;
  }
}

Interval angle(const Interval& y, const Interval& x) {
  constexpr double pi = std::numbers::pi;
  const bool meets_cut = x.lower() < 0 && y.lower() < 0 && y.upper() > 0;
  if (meets_cut || !is_known(x) || !is_known(y)) return {-pi, pi};
  if (y.upper() <= 0 && y.lower() < 0) return -angle(-y, x);
  const bool meets_origin = x.lower() <= 0 && x.upper() >= 0 && y.lower() <= 0;
  if (meets_origin) return {y.lower() < 0 ? -pi / 2 : 0, x.lower() < 0 ? pi : pi / 2};
  // Away from origin and cut the angle is largest and least in corners.
  const double angles[] = {std::atan2(y.lower(), x.lower()), std::atan2(y.lower(), x.upper()),
                           std::atan2(y.upper(), x.lower()), std::atan2(y.upper(), x.upper())};
  return {*std::ranges::min_element(angles), *std::ranges::max_element(angles)};
}

Interval power(const Interval& a, double exponent) {
  if (exponent == 0) return 1;  // also of 0, where Boost's has no value
  const bool is_whole = exponent == std::floor(exponent) && std::abs(exponent) <= 1000;
  if (is_whole && exponent >= 0) return boost::numeric::pow(a, static_cast<int>(exponent));
  if (is_whole) return inverse(boost::numeric::pow(a, static_cast<int>(-exponent)));
  const auto f = [&](double x) { return std::pow(x, exponent); };
  if (exponent > 0) return rising_from(0, a, f);
  const Interval inside = from(0, a, largest(a));
  return inside.lower() >= 0 && inside.upper() > 0 ? falling(inside, f) : kAnything;
}

/// Where a ≥ 0 it rises or falls in each of both: it is largest and least in corners, but that it tends to 0
/// beside 0^0 = 1.
Interval power(const Interval& a, const Interval& exponent) {
  if (exponent.lower() == exponent.upper()) return power(a, exponent.lower());
  const Interval inside = from(0, a, largest(a));
  if (!(inside.lower() >= 0) || !is_known(inside) || !is_known(exponent)) return kAnything;
  if (inside.lower() == 0 && exponent.lower() < 0) return kAnything;
  const Interval first = power(inside, exponent.lower()), second = power(inside, exponent.upper());
  return boost::numeric::hull(inside.lower() == 0 ? boost::numeric::hull(first, Interval(0)) : first, second);
}

}  // namespace signorini
