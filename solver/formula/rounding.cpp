#include "formula/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formula/evaluation.hpp"

namespace signorini {
namespace {

constexpr double kUnit = std::numeric_limits<double>::epsilon();

/// A number, and what it may be off by.
struct Rounded {
  double value, error = 0;
};

/// What is exact stays so where a function is infinitely steep.
double times(double slope, double error) {
  return error == 0 ? 0 : std::abs(slope) * error;
}

/// Of a function that begins like a root: near that point its slope says too much.
double of_root(double slope, double error) {
  return std::min(times(slope, error), 2 * std::sqrt(error));
}

/// What an argument that is off by so much makes of the result r = f(a).
double carried(Operation operation, double a, double r, double error) {
  switch (operation) {
    case Operation::sqrt:
      return of_root(0.5 / r, error);
    case Operation::exp:
      return times(r, error);
    case Operation::ln:
    case Operation::log:
      return times(1 / a, error);
    case Operation::log2:
      return times(1 / (a * std::log(2.)), error);
    case Operation::log10:
      return times(1 / (a * std::log(10.)), error);
    case Operation::sin:
      return std::min(2., times(std::cos(a), error) + error * error);
    case Operation::cos:
      return std::min(2., times(std::sin(a), error) + error * error);
    case Operation::tan:
      return times(1 + r * r, error);
    case Operation::asin:
    case Operation::acos:
      return of_root(1 / std::sqrt(1 - a * a), error);
    case Operation::atan:
      return times(1 / (1 + a * a), error);
    case Operation::sinh:
      return times(std::cosh(a), error);
    case Operation::cosh:
      return times(std::sinh(a), error);
    case Operation::tanh:
      return times(1 - r * r, error);
    case Operation::asinh:
      return times(1 / std::sqrt(1 + a * a), error);
    case Operation::acosh:
      return of_root(1 / std::sqrt(a * a - 1), error);
    case Operation::atanh:
      return times(1 / (1 - a * a), error);
    case Operation::negate:
    case Operation::abs:
      return error;
    default:  // sign and rint, but where they jump
      return 0;
  }
}

double carried(Operation operation, const Rounded& a, const Rounded& b, double r) {
  switch (operation) {
    case Operation::add:
    case Operation::subtract:
      return a.error + b.error;
    case Operation::multiply:
      return times(b.value, a.error) + times(a.value, b.error) + a.error * b.error;
    case Operation::divide:
      return times(1 / b.value, a.error) + times(r / b.value, b.error);
    case Operation::power:
      return times(b.value * r / a.value, a.error) + times(r * std::log(std::abs(a.value)), b.error);
    case Operation::atan2: {
      const double square = a.value * a.value + b.value * b.value;
      return times(b.value / square, a.error) + times(a.value / square, b.error);
    }
    case Operation::min:
    case Operation::max:
      return std::max(a.error, b.error);
    default:  // comparisons
      return 0;
  }
}

bool rounds(Operation operation) {
  const bool is_exact = operation == Operation::negate || operation == Operation::abs ||
                        operation == Operation::sign || operation == Operation::rint ||
                        operation == Operation::min || operation == Operation::max;
  return !is_exact && operation < Operation::less;
}

struct RunningError {
  Rounded x, y, nx, ny;

  /// A decimal fraction is none in binary.
  Rounded constant(double value) const {
    return {value, value == std::rint(value) ? 0 : kUnit / 2 * std::abs(value)};
  }

  Rounded operator()(Operation operation, const Rounded& a) const {
    const double r = Evaluation{}(operation, a.value);
    return rounded(operation, r, carried(operation, a.value, r, a.error));
  }

  Rounded operator()(Operation operation, const Rounded& a, const Rounded& b) const {
    const double r = Evaluation{}(operation, a.value, b.value);
    return rounded(operation, r, carried(operation, a, b, r));
  }

  Rounded operator()(Operation, const Rounded& condition, const Rounded& a, const Rounded& b) const {
    return condition.value != 0 ? a : b;
  }

 private:
  static Rounded rounded(Operation operation, double r, double carried) {
    return {r, carried + (rounds(operation) ? kUnit * std::abs(r) : 0)};
  }
};

}  // namespace

double rounding_of(const Formula& formula, double x, double y, double nx, double ny) {
  RunningError arithmetic{{x}, {y}, {nx}, {ny}};
  return formula.evaluate(arithmetic).error;
}

}  // namespace signorini
