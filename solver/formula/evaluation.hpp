#pragma once

#include <algorithm>
#include <cmath>

#include "formula/formula.hpp"

namespace signorini {

/// Doubles at one point.
struct Evaluation {
  double x, y, nx, ny;

  double constant(double value) const { return value; }

  double operator()(Operation operation, double a) const {
    switch (operation) {
      case Operation::negate:
        return -a;
      case Operation::abs:
        return std::abs(a);
      case Operation::sign:
        return a > 0 ? 1 : (a < 0 ? -1 : 0);
      case Operation::rint:
        return std::floor(a + 0.5);
      case Operation::sqrt:
        return std::sqrt(a);
      case Operation::exp:
        return std::exp(a);
      case Operation::ln:
      case Operation::log:
        return std::log(a);
      case Operation::log2:
        return std::log2(a);
      case Operation::log10:
        return std::log10(a);
      case Operation::sin:
        return std::sin(a);
      case Operation::cos:
        return std::cos(a);
      case Operation::tan:
        return std::tan(a);
      case Operation::asin:
        return std::asin(a);
      case Operation::acos:
        return std::acos(a);
      case Operation::atan:
        return std::atan(a);
      case Operation::sinh:
        return std::sinh(a);
      case Operation::cosh:
        return std::cosh(a);
      case Operation::tanh:
        return std::tanh(a);
      case Operation::asinh:
        return std::asinh(a);
      case Operation::acosh:
        return std::acosh(a);
      default:
        return std::atanh(a);
    }
  }

  double operator()(Operation operation, double a, double b) const {
    switch (operation) {
      case Operation::add:
        return a + b;
      case Operation::subtract:
        return a - b;
      case Operation::multiply:
        return a * b;
      case Operation::divide:
        return a / b;
      case Operation::power:
        return b == 2 ? a * a : std::pow(a, b);
      case Operation::atan2:
        return std::atan2(a, b);
      case Operation::min:
        return std::min(a, b);
      case Operation::max:
        return std::max(a, b);
      case Operation::less:
        return a < b;
      case Operation::less_equal:
        return a <= b;
      case Operation::greater:
        return a > b;
      case Operation::greater_equal:
        return a >= b;
      case Operation::equal:
        return a == b;
      case Operation::unequal:
        return a != b;
      case Operation::both:
        return a != 0 && b != 0;
      default:
        return a != 0 || b != 0;
    }
  }

  double operator()(Operation, double condition, double a, double b) const { return condition != 0 ? a : b; }
};

}  // namespace signorini
