#pragma once

#include <string>

#include "problem/field.hpp"

namespace signorini::api {

/// Where an expression is evaluated: inside the domain it may use x, y; on the boundary also the outward
/// unit normal nx, ny.
enum class Variables { interior, boundary };

/// Reads an expression (parse_formula) as a field named by its JSON pointer. Throws InvalidProblem with that
/// pointer if the text is too long, holds what no expression may hold (assignment, several expressions, other
/// variables) or does not parse.
Field compile_expression(const std::string& text, const std::string& pointer, Variables variables);

}  // namespace signorini::api
