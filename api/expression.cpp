#include "api/expression.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <muParser.h>

#include "api/expression_text.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

/// The parser and the variables that it is bound to; it keeps their addresses, so it stays where it is.
class Formula {
 public:
  Formula(const std::string& text, Variables variables) {
    parser_.ClearConst();  // muParser's own _pi has but twelve digits
    parser_.DefineConst("pi", std::numbers::pi);
    parser_.DefineVar("x", &x_);
    parser_.DefineVar("y", &y_);
    if (variables == Variables::boundary) {
      parser_.DefineVar("nx", &nx_);
      parser_.DefineVar("ny", &ny_);
    }
    parser_.SetExpr(text);
  }
  Formula(const Formula&) = delete;
  Formula& operator=(const Formula&) = delete;

  double operator()(const Point& x, const Vector& normal) {
    x_ = x.x();
    y_ = x.y();
    nx_ = normal.x();
    ny_ = normal.y();
    return parser_.Eval();
  }

  /// The number of expressions that commas separate; known after an evaluation.
  int results() const { return parser_.GetNumResults(); }

  std::vector<std::string_view> functions() const {
    std::vector<std::string_view> names;
    for (const auto& [name, callback] : parser_.GetFunDef()) names.push_back(name);
    return names;
  }

 private:
  mu::Parser parser_;
  double x_ = 0, y_ = 0, nx_ = 0, ny_ = 0;
};

std::vector<std::string_view> variable_names(Variables variables) {
  if (variables == Variables::boundary) return {"x", "y", "nx", "ny"};
  return {"x", "y"};
}

bool holds(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// What is wrong with the names in the expression, or nothing.
std::string name_fault(const std::string& text, const Formula& formula, Variables variables) {
  const auto known = variable_names(variables), functions = formula.functions();
  for (const std::string_view name : names_in(text)) {
    if (holds(known, name) || holds(functions, name) || name == "pi") continue;
    return in_quotes(name) + " is not known" + suggestion(name, functions) +
           "; variables: " + list_of(known) + "; constant: pi; functions: " + list_of(functions);
  }
  return {};
}

bool uses_variables(const std::string& text, Variables variables) {
  const auto names = names_in(text), known = variable_names(variables);
  return std::ranges::any_of(names, [&](std::string_view name) { return holds(known, name); });
}

}  // namespace

Field compile_expression(const std::string& text, const std::string& pointer, Variables variables) {
  const auto refuse = [&](const std::string& why) { throw InvalidProblem({{pointer, why}}); };

  if (const std::string fault = text_fault(text); !fault.empty()) refuse(fault);
  const std::string tidy = without_blanks_before_arguments(text);
  const auto formula = std::make_shared<Formula>(tidy, variables);
  if (const std::string fault = name_fault(tidy, *formula, variables); !fault.empty()) refuse(fault);

  // muParser compiles in the first evaluation; its error is no std::exception.
  double first = 0;
  try {
    first = (*formula)(Point::Zero(), Vector::Zero());
  } catch (const mu::ParserError& error) {
    refuse("the expression does not parse: " + error.GetMsg());
  }
  if (formula->results() != 1) refuse("these are several expressions, separated by commas; give one");

  if (!uses_variables(tidy, variables)) {
    if (!std::isfinite(first)) refuse("the expression is not finite");
    return Field(first, pointer);
  }
  return Field(
      [formula, pointer](const Point& x, const Vector& normal) {
        try {
          return (*formula)(x, normal);
        } catch (const mu::ParserError& error) {
          throw InvalidProblem({{pointer, "cannot be evaluated at " + to_string(x) + ": " + error.GetMsg()}});
        }
      },
      pointer);
}

}  // namespace signorini::api
