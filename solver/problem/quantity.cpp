#include "problem/quantity.hpp"

#include "problem/problem.hpp"

namespace signorini {
namespace {

/// a + b times a coordinate.
Field linear(double a, double b, Operation coordinate) {
  return {Formula({{Operation::constant, a},
                   {Operation::constant, b},
                   {coordinate},
                   {Operation::multiply},
                   {Operation::add}}),
          {}};
}

VectorField field_of(const SupportMotion& motion, int components) {
  if (components == 1) return {Field(motion.translation.x())};
  return {linear(motion.translation.x(), -motion.rotation, Operation::y),
          linear(motion.translation.y(), motion.rotation, Operation::x)};
}

/// The same kind of condition, which leaves the operator as it is.
Condition without_data(const Condition& condition) {
  if (const auto* contact = std::get_if<Contact>(&condition)) {
    Contact own = *contact;
    own.gap = Field(0);
    return own;
  }
  if (std::holds_alternative<Fixed>(condition)) return Fixed{};
  if (std::holds_alternative<Roller>(condition)) return Roller{};
  return Traction{};
}

}  // namespace

Problem dual_problem(const Problem& problem, const Quantity& quantity) {
  Problem all = problem;
  all.load_key.clear();
  all.quantities.clear();
  all.body = quantity.density;
  for (auto& [part, condition] : all.boundary) condition = without_data(condition);
  for (const auto& [part, weight] : quantity.weights) std::get<Contact>(all.boundary.at(part)).gap = weight;
  for (const auto& [part, motion] : quantity.motions) {
    const SupportMotion back{-motion.translation, -motion.rotation};
    Condition& condition = all.boundary.at(part);
    if (auto* roller = std::get_if<Roller>(&condition))
      roller->motion = back;
    else
      std::get<Fixed>(condition).value = field_of(back, components(problem.material));
  }
  for (const auto& [part, density] : quantity.densities) all.boundary[part] = Traction{density};
  return all;
}

}  // namespace signorini
