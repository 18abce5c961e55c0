#include "problem/fields.hpp"

namespace signorini {
namespace {

std::vector<const Field*> pointers_to(const auto& fields) {
  std::vector<const Field*> pointers;
  for (const Field& field : fields) pointers.push_back(&field);
  return pointers;
}

/// What an operation takes, as measured; of the angles those beyond 1e22.
double steps_of(Operation operation) {
  if (operation == Operation::power) return 4;
  const bool is_function =
      (Operation::exp <= operation && operation <= Operation::atanh) || operation == Operation::atan2;
  return is_function ? 3 : 1;
}

/// The arithmetic in which the value of a formula is the number of its steps.
struct Counting {
  double x = 1, y = 1, nx = 1, ny = 1;

  double constant(double) const { return 1; }
  double operator()(Operation operation, double a, double b = 0, double c = 0) const {
    return a + b + c + steps_of(operation);
  }
};

}  // namespace

std::vector<const Field*> fields_of(const Material& material) {
  if (const auto* membrane = std::get_if<MembraneStiffness>(&material))
    return {&membrane->xx, &membrane->xy, &membrane->yy};
  if (const auto* isotropic = std::get_if<YoungPoisson>(&material))
    return {&isotropic->young, &isotropic->poisson};
  return pointers_to(std::get<HookeTensor>(material).entries);
}

std::vector<const Field*> fields_of(const Condition& condition) {
  if (const auto* fixed = std::get_if<Fixed>(&condition)) return pointers_to(fixed->value.fields());
  if (const auto* traction = std::get_if<Traction>(&condition)) return pointers_to(traction->value.fields());
  if (const auto* pressure = std::get_if<Pressure>(&condition)) return {&pressure->value};
  if (const auto* contact = std::get_if<Contact>(&condition)) return {&contact->gap};
  return {};
}

double steps_of(const std::vector<const Field*>& fields) {
  double steps = 10;  // about what it takes to find the place
  Counting counting;
  for (const Field* field : fields)
    if (field->formula()) steps += field->formula()->evaluate(counting);
  return steps;
}

}  // namespace signorini
