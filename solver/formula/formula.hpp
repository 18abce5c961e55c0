#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace signorini {

/// What a formula is made of. The order is that of kOperations in formula.cpp.
enum class Operation : std::uint8_t {
  // clang-format off
  constant, x, y, nx, ny,
  negate, abs, sign, rint, sqrt, exp, ln, log, log2, log10, sin, cos, tan, asin, acos, atan,
  sinh, cosh, tanh, asinh, acosh, atanh,
  add, subtract, multiply, divide, power, atan2, min, max,
  less, less_equal, greater, greater_equal, equal, unequal, both, either,
  choose,
  // clang-format on
};

/// The operands that the operation takes: 0 for a constant or a variable, 3 for `? :`.
int operands(Operation operation);

/// An expression of x, y and, on a boundary, of the outward normal, as a program for a stack: operands first,
/// then their operation. It is evaluated in whatever arithmetic is asked for, in doubles or in enclosures, so
/// that there is one reading of it. Immutable; any number of threads may evaluate it.
class Formula {
 public:
  struct Instruction {
    Operation operation;
    double constant = 0;
  };

  /// Operands must stand before their operations, and one value be left.
  explicit Formula(std::vector<Instruction> program);

  /// Calls `arithmetic(operation, a, b, c)` with as many operands as the operation takes, and takes the
  /// variables from its members x, y, nx and ny, the numbers from its `constant(number)`; answers the last
  /// value.
  template <typename Arithmetic>
  auto evaluate(Arithmetic& arithmetic) const {
    using Value = decltype(arithmetic.constant(0.));
    std::vector<Value> stack;
    stack.reserve(depth_);
    const auto top = [&](int below) -> Value& { return stack[stack.size() - 1 - below]; };
    for (const Instruction& step : program_) {
      switch (operands(step.operation)) {
        case 0:
          stack.push_back(leaf(arithmetic, step));
          break;
        case 1:
          top(0) = arithmetic(step.operation, top(0));
          break;
        case 2:
          top(1) = arithmetic(step.operation, top(1), top(0));
          stack.pop_back();
          break;
        default:
          top(2) = arithmetic(step.operation, top(2), top(1), top(0));
          stack.resize(stack.size() - 2, top(2));
      }
    }
    return stack.front();
  }

  double operator()(double x, double y, double nx = 0, double ny = 0) const;

  /// This formula plus a number times another.
  Formula plus(double factor, const Formula& other) const;

  /// Some value of it is not the same everywhere.
  bool has_variables() const;
  /// It chooses between values.
  bool has_branches() const;
  /// Variables are but compared, so that its values are some of a few.
  bool has_few_values() const;

 private:
  template <typename Arithmetic>
  static auto leaf(const Arithmetic& arithmetic, const Instruction& step) {
    switch (step.operation) {
      case Operation::x:
        return arithmetic.x;
      case Operation::y:
        return arithmetic.y;
      case Operation::nx:
        return arithmetic.nx;
      case Operation::ny:
        return arithmetic.ny;
      default:
        return arithmetic.constant(step.constant);
    }
  }

  std::vector<Instruction> program_;
  std::size_t depth_ = 0;
};

/// The names of the functions that an expression may call.
const std::vector<std::string_view>& function_names();

/// Reads an expression with the operators `? :`, `||`, `&&`, comparisons, `+ -`, `* /`, signs, `^` (from weak
/// to strong; `^` from the right), the functions of function_names(), numbers, `pi`, and the variables x, y
/// and, if `on_boundary`, nx, ny. Throws std::invalid_argument with what is wrong and where.
Formula parse_formula(std::string_view text, bool on_boundary);

}  // namespace signorini
