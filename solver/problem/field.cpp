#include "problem/field.hpp"

#include <charconv>
#include <cmath>

namespace signorini {
namespace {

std::string shortest(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  return {digits, end};
}

std::string join(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) {
    if (!text.empty()) text += "; ";
    text += fault.where + ": " + fault.detail;
  }
  return text;
}

}  // namespace

InvalidProblem::InvalidProblem(std::vector<Fault> faults)
    : std::runtime_error(join(faults)), faults_(std::move(faults)) {}

Field::Field(double constant, std::string name) : constant_(constant), name_(std::move(name)) {}

Field::Field(Formula formula, std::string name) : name_(std::move(name)) {
  if (formula.has_variables())
    formula_ = std::make_shared<const Formula>(std::move(formula));
  else
    constant_ = formula(0, 0);
}

Field::Field(Function function, std::string name) : function_(std::move(function)), name_(std::move(name)) {}

Field Field::quadratic_on_edges(Function function, std::string name) {
  Field field(std::move(function), std::move(name));
  field.quadratic_on_edges_ = true;
  return field;
}

/// Of one that is no function.
Formula Field::as_formula() const {
  return formula_ ? *formula_ : Formula({{Operation::constant, constant_}});
}

Field Field::plus(double factor, const Field& other) const {
  if (!function_ && !other.function_) return {as_formula().plus(factor, other.as_formula()), name_};
  const Function sum = [one = *this, factor, two = other](const Point& x, const Vector& normal) {
    return one(x, normal) + factor * two(x, normal);
  };
  return {sum, name_};
}

double Field::checked(double value, const Point& x) const {
  if (std::isfinite(value)) return value;
  throw InvalidProblem({{name_, "is not finite at " + to_string(x) + ": " + shortest(value)}});
}

std::string not_known_to_be_finite(const Field& field, const Point& x) {
  return field.name() + " is not known to be finite near " + to_string(x) +
         ": where it divides by what vanishes, or takes a root or a logarithm of it, give its values by ? :";
}

std::string to_string(const Point& x) {
  return "(" + shortest(x.x()) + ", " + shortest(x.y()) + ")";
}

}  // namespace signorini
