#pragma once

#include <boost/numeric/interval.hpp>

#include "formula/formula.hpp"

namespace signorini {

/// A closed interval of reals, its ends computed in doubles without directed rounding: what the ends are
/// rounded by is taken to be kEnclosureRounding of the numbers that they are made of (certify/THEORY.md,
/// "Assumptions"): a sign within it counts as zero, a rest within it as none. Where nothing is known, as for
/// 1/x around 0, it is the whole line.
using Interval = boost::numeric::interval<
    double,
    boost::numeric::interval_lib::policies<boost::numeric::interval_lib::save_state_nothing<
                                               boost::numeric::interval_lib::rounded_transc_exact<double>>,
                                           boost::numeric::interval_lib::checking_base<double>>>;

/// What a number that a few operations made in doubles may be wrong by, relative to the numbers it is made
/// of.
inline constexpr double kEnclosureRounding = 1e-14;

inline const Interval kAnything = Interval::whole();

inline bool is_known(const Interval& a) {
  return std::isfinite(a.lower()) && std::isfinite(a.upper());
}

/// The largest absolute value.
inline double largest(const Interval& a) {
  return std::max(std::abs(a.lower()), std::abs(a.upper()));
}

/// What lies in both, which hold the same values: where rounding has parted them, what lies between.
Interval intersection(const Interval& a, const Interval& b);

/// a + sign · b. An end that has the other sign than the rest by rounding alone, beside the numbers that it
/// is made of, is zero: 1 − x is not negative where x is at most 1.
Interval sum(const Interval& a, const Interval& b, double sign);

/// a / b: half a line where b is 0 at one end.
Interval quotient(const Interval& a, const Interval& b);

/// The values of a function of one variable on an interval: the whole line where it is not defined on all of
/// it.
Interval range(Operation operation, const Interval& a);

/// The angle of the points (x, y): all angles around the origin, and where the intervals lie on both sides of
/// the negative x axis.
Interval angle(const Interval& y, const Interval& x);

/// The values of a^α and of a^b.
Interval power(const Interval& a, double exponent);
Interval power(const Interval& a, const Interval& exponent);

}  // namespace signorini
