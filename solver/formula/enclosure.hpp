#pragma once

#include <optional>
#include <vector>

#include "formula/formula.hpp"
#include "formula/interval.hpp"

namespace signorini {

/// Evaluates a formula in enclosures of its values on a cell: Series on an interval, TaylorModel on a
/// triangle. Statements hold almost everywhere: what is so in single points and on lines does not count, and
/// a difference that is rounding counts as none. Where the difference has a slope all over the cell, it has
/// the other sign on a sliver at most. Where it has none, as around a minimum, rounding may hide a place that
/// is small but where a function is large: there nothing is decided by rounding, if it is `strict`.
///
/// Where a comparison is not decided on the cell, or a kink may lie in it, the result encloses all cases, and
/// `undecided` is what changes its sign there: to cut the cell where it is 0 decides it.
///
/// What is assumed of the sign of such an argument holds for all formulas that are evaluated: their values
/// are then those in the points of the cell where it is so, as they belong together.
template <typename Value>
class Enclosure {
 public:
  struct Assumption {
    Value argument;
    bool is_positive;
  };

  Value x, y, nx, ny;
  std::vector<Assumption> assumptions = {};
  bool strict = true;
  std::optional<Value> undecided = std::nullopt;

  Value constant(double value) const { return constant_like(x, value); }

  Value operator()(Operation operation, const Value& a) {
    switch (operation) {
      case Operation::abs:
        switch (sign_of(a, 0)) {
          case Sign::positive:
            return narrowed(a, boost::numeric::abs(range(a)));
          case Sign::negative:
            return narrowed(smooth(Operation::negate, a), boost::numeric::abs(range(a)));
          case Sign::zero:
            return constant(0);
          default:
            return rough_like(a, boost::numeric::abs(range(a)));
        }
      case Operation::sign:
        return stepped(sign_of(a, 0), -1, 0, 1);
      case Operation::rint:
        return rounded(a);
      default:
        return smooth(operation, a);
    }
  }

  Value operator()(Operation operation, const Value& a, const Value& b) {
    switch (operation) {
      case Operation::min:
      case Operation::max:
        return extreme(a, b, operation == Operation::min);
      case Operation::less:
        return stepped(sign_of_difference(a, b), 1, 0, 0);
      case Operation::less_equal:
        return stepped(sign_of_difference(a, b), 1, 1, 0);
      case Operation::greater:
        return stepped(sign_of_difference(a, b), 0, 0, 1);
      case Operation::greater_equal:
        return stepped(sign_of_difference(a, b), 0, 1, 1);
      case Operation::equal:
        return stepped(sign_of_difference(a, b), 0, 1, 0);
      case Operation::unequal:
        return stepped(sign_of_difference(a, b), 1, 0, 1);
      case Operation::both:
        return both(a, b);
      case Operation::either:
        return smooth(Operation::subtract, constant(1), both(inverted(a), inverted(b)));
      case Operation::atan2:
        // Beside the negative x axis it jumps where y changes its sign.
        if (range(b).lower() < 0) (void)sign_of(a, 0);
        return smooth(operation, a, b);
      default:
        return smooth(operation, a, b);
    }
  }

  Value operator()(Operation, const Value& condition, const Value& a, const Value& b) const {
    if (is_true(condition)) return a;
    return is_false(condition) ? b : hull(a, b);
  }

 private:
  enum class Sign { negative, zero, positive, unknown };

  static bool is_true(const Value& a) { return range(a).lower() > 0 || range(a).upper() < 0; }
  static bool is_false(const Value& a) { return range(a).lower() == 0 && range(a).upper() == 0; }

  /// `scale`: of the numbers whose difference a is.
  Sign sign_of(const Value& a, double scale) {
    const Interval& values = range(a);
    const double rounding = kEnclosureRounding * std::max(scale, largest(values));
    if (largest(values) <= kEnclosureRounding * scale) return Sign::zero;
    const double least = !strict || has_slope(a, rounding) ? -rounding : rounding;
    if (values.lower() >= least) return Sign::positive;
    if (values.upper() <= -least) return Sign::negative;
    for (const Assumption& own : assumptions) {
      if (is_same(own.argument, a)) return own.is_positive ? Sign::positive : Sign::negative;
      if (is_same(own.argument, smooth(Operation::negate, a)))
        return own.is_positive ? Sign::negative : Sign::positive;
    }
    if (!undecided) undecided = a;
    return Sign::unknown;
  }

  Sign sign_of_difference(const Value& a, const Value& b) {
    return sign_of(smooth(Operation::subtract, a, b), largest(range(a)) + largest(range(b)));
  }

  Value stepped(Sign sign, double below, double at, double above) const {
    if (sign == Sign::unknown) return rough_like(x, Interval(std::min(below, above), std::max(below, above)));
    return constant(sign == Sign::negative ? below : (sign == Sign::zero ? at : above));
  }

  Value extreme(const Value& a, const Value& b, bool least) {
    const Interval values =
        least ? boost::numeric::min(range(a), range(b)) : boost::numeric::max(range(a), range(b));
    switch (sign_of_difference(a, b)) {
      case Sign::negative:
        return narrowed(least ? a : b, values);
      case Sign::unknown: {
        // ½ (a + b) ∓ ½ |a − b|
        const Value half = constant(0.5),
                    mean = smooth(Operation::multiply, half, smooth(Operation::add, a, b)),
                    rest = smooth(Operation::multiply, half, smooth(Operation::subtract, a, b)),
                    size = rough_like(x, boost::numeric::abs(range(rest)));
        return narrowed(smooth(least ? Operation::subtract : Operation::add, mean, size), values);
      }
      default:
        return narrowed(least ? b : a, values);
    }
  }

  /// The next whole number, upwards half-way.
  Value rounded(const Value& a) {
    const Interval& values = range(a);
    const double low = std::floor(values.lower() + 0.5), high = std::floor(values.upper() + 0.5);
    if (low == high) return constant(low);
    if (!is_known(values)) return rough_like(x, kAnything);
    const Sign sign = sign_of_difference(a, constant(high - 0.5));
    if (sign == Sign::positive) return constant(high);
    if (sign == Sign::negative && high == low + 1) return constant(low);
    return narrowed(smooth(Operation::add, a, rough_like(x, Interval(-0.5, 0.5))), Interval(low, high));
  }

  Value both(const Value& a, const Value& b) const {
    if (is_false(a) || is_false(b)) return constant(0);
    if (is_true(a) && is_true(b)) return constant(1);
    return rough_like(x, Interval(0, 1));
  }

  Value inverted(const Value& a) const {
    if (is_true(a)) return constant(0);
    return is_false(a) ? constant(1) : rough_like(x, Interval(0, 1));
  }
};

}  // namespace signorini
