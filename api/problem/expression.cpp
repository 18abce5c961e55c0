#include "api/problem/expression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "api/problem/expression_text.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

std::vector<std::string_view> variable_names(Variables variables) {
  if (variables == Variables::boundary) return {"x", "y", "nx", "ny"};
  return {"x", "y"};
}

bool holds(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// What is wrong with the names in the expression, or nothing.
std::string name_fault(const std::string& text, Variables variables) {
  const auto known = variable_names(variables);
  const std::vector<std::string_view>& functions = function_names();
  for (const std::string_view name : names_in(text)) {
    if (holds(known, name) || holds(functions, name) || name == "pi") continue;
    return in_quotes(name) + " is not known" + suggestion(name, functions) +
           "; variables: " + list_of(known) + "; constant: pi; functions: " + list_of(functions);
  }
  return {};
}

}  // namespace

Field compile_expression(const std::string& text, const std::string& pointer, Variables variables) {
  const auto refuse = [&](const std::string& why) { throw InvalidProblem({{pointer, why}}); };

  if (const std::string fault = text_fault(text); !fault.empty()) refuse(fault);
  if (const std::string fault = name_fault(text, variables); !fault.empty()) refuse(fault);
  try {
    Formula formula = parse_formula(text, variables == Variables::boundary);
    if (!formula.has_variables() && !std::isfinite(formula(0, 0))) refuse("the expression is not finite");
    return Field(std::move(formula), pointer);
  } catch (const std::invalid_argument& fault) {
    refuse("the expression does not parse: " + std::string(fault.what()));
    throw;
  }
}

}  // namespace signorini::api
