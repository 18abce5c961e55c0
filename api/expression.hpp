#pragma once

#include <string>

#include "problem/field.hpp"

namespace signorini::api {

/// Where an expression is evaluated: inside the domain it may use x, y; on the boundary also the outward
/// unit normal nx, ny.
enum class Variables { interior, boundary };

/// Compiles an expression (muParser's functions and operators, `? :`, `&&`, `||`, the constant `pi`) to
/// a field named by its JSON pointer. Throws InvalidProblem with that pointer if the text is too long,
/// holds what no expression may hold (assignment, several expressions, other variables) or does not parse.
///
/// The field must not be evaluated by two threads at once; copies share their state.
Field compile_expression(const std::string& text, const std::string& pointer, Variables variables);

}  // namespace signorini::api
