#include "formula/formula.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace signorini {
namespace {

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

}  // namespace

int operands(Operation operation) {
  if (operation < Operation::negate) return 0;
  if (operation < Operation::add) return 1;
  return operation < Operation::choose ? 2 : 3;
}

Formula::Formula(std::vector<Instruction> program) : program_(std::move(program)) {
  std::size_t height = 0;
  for (const Instruction& step : program_) {
    height += 1 - operands(step.operation);
    depth_ = std::max(depth_, height);
  }
  if (height != 1) throw std::logic_error("a formula leaves one value");
}

double Formula::operator()(double x, double y, double nx, double ny) const {
  Evaluation evaluation{x, y, nx, ny};
  return evaluate(evaluation);
}

bool Formula::has_variables() const {
  return std::ranges::any_of(program_, [](const Instruction& step) {
    return step.operation > Operation::constant && step.operation < Operation::negate;
  });
}

}  // namespace signorini
