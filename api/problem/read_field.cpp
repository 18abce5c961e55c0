#include "api/problem/problem_members.hpp"

namespace signorini::api {

std::optional<Field> read_field(const Value& value, Variables variables) {
  if (value.json().is_number()) return Field(value.json().get<double>(), value.pointer());
  const auto* text = value.json().get_ptr<const std::string*>();
  if (text == nullptr) {
    value.unexpected("a number or a string with an expression");
    return std::nullopt;
  }
  try {
    return compile_expression(*text, value.pointer(), variables);
  } catch (const InvalidProblem& invalid) {
    value.faults().add(invalid);
    return std::nullopt;
  }
}

std::optional<VectorField> read_vector_field(const Value& value, Model model, Variables variables) {
  if (model == Model::membrane) {
    const auto field = read_field(value, variables);
    return field ? std::optional<VectorField>(*field) : std::nullopt;
  }
  const auto pair = value.elements(2, "an array of two numbers or expressions, [x, y]");
  if (!pair) return std::nullopt;
  const auto x = read_field((*pair)[0], variables), y = read_field((*pair)[1], variables);
  if (!x || !y) return std::nullopt;
  return VectorField(*x, *y);
}

}  // namespace signorini::api
