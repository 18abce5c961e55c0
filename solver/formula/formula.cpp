#include "formula/formula.hpp"

#include <algorithm>
#include <stdexcept>

#include "formula/evaluation.hpp"

namespace signorini {

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

Formula Formula::plus(double factor, const Formula& other) const {
  std::vector<Instruction> program = program_;
  program.push_back({Operation::constant, factor});
  program.insert(program.end(), other.program_.begin(), other.program_.end());
  program.push_back({Operation::multiply});
  program.push_back({Operation::add});
  return Formula(std::move(program));
}

bool Formula::has_variables() const {
  return std::ranges::any_of(program_, [](const Instruction& step) {
    return step.operation > Operation::constant && step.operation < Operation::negate;
  });
}

bool Formula::has_branches() const {
  return std::ranges::any_of(program_,
                             [](const Instruction& step) { return step.operation == Operation::choose; });
}

namespace {

/// Counts the variables that a value follows, other than by comparing them.
struct Following {
  double x = 1, y = 1, nx = 1, ny = 1;

  double constant(double) const { return 0; }
  template <typename... Values>
  double operator()(Operation operation, const Values&... of) const {
    const bool compares = operation >= Operation::less && operation <= Operation::either;
    return compares ? 0 : (of + ...);
  }
  double operator()(Operation, double, double one, double other) const { return one + other; }
};

}  // namespace

bool Formula::has_few_values() const {
  Following following;
  return evaluate(following) == 0;
}

}  // namespace signorini
