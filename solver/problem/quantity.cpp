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

}  // namespace

Problem neighbour(const Problem& problem, const Quantity& quantity, double z) {
  Problem all = problem;
  all.load_key.clear();
  all.quantities.clear();
  all.body = problem.body.plus(z, quantity.density);
  for (const auto& [part, weight] : quantity.weights) {
    Contact& contact = std::get<Contact>(all.boundary.at(part));
    contact.gap = contact.gap.plus(z, weight);
  }
  for (const auto& [part, motion] : quantity.motions) {
    Condition& condition = all.boundary.at(part);
    if (auto* roller = std::get_if<Roller>(&condition)) {
      roller->motion.translation -= z * motion.translation;
      roller->motion.rotation -= z * motion.rotation;
      continue;
    }
    Fixed& fixed = std::get<Fixed>(condition);
    fixed.value = fixed.value.plus(-z, field_of(motion, components(problem.material)));
  }
  for (const auto& [part, density] : quantity.densities) {
    Condition& condition = all.boundary.try_emplace(part, Traction{}).first->second;
    VectorField& traction = std::holds_alternative<Pressure>(condition)
                                ? std::get<Pressure>(condition).besides
                                : std::get<Traction>(condition).value;
    traction = traction.plus(z, density);
  }
  return all;
}

}  // namespace signorini
