#include <algorithm>
#include <set>

#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"
#include "mesh/domain_mesh.hpp"

namespace signorini::api {
namespace {

/// A type of condition reads its own members of the object; nothing if they are not what it takes.
using ReadCondition = std::optional<Condition> (*)(const Object& object, Model model);

template <typename Kind>
std::optional<Condition> read_value(const Object& object, Model model) {
  object.allow({"type", "value"}, "this type of condition");
  const auto value = object.find("value");
  if (!value) return Kind{};
  const auto field = read_vector_field(*value, model, Variables::boundary);
  return field ? std::optional<Condition>(Kind{*field}) : std::nullopt;
}

std::optional<Condition> read_traction(const Object& object, Model model) {
  const auto pressure = object.find("pressure");
  if (!pressure || model == Model::membrane) return read_value<Traction>(object, model);
  object.allow({"type", "pressure"}, "a traction by a pressure");
  const auto field = read_field(*pressure, Variables::boundary);
  return field ? std::optional<Condition>(Pressure{*field}) : std::nullopt;
}

std::optional<Condition> read_roller(const Object& object, Model) {
  object.allow({"type"}, "a roller");
  return Roller{};
}

std::optional<Condition> read_contact(const Object& object, Model model) {
  if (model == Model::membrane)
    object.allow({"type", "gap"}, "a contact of a membrane");
  else
    object.allow({"type", "gap", "direction"}, "a contact");
  Contact contact;
  if (const auto gap = object.find("gap")) {
    const auto field = read_field(*gap, Variables::boundary);
    if (!field) return std::nullopt;
    contact.gap = *field;
  }
  if (const auto direction = object.find("direction")) {
    const auto pair = read_pair(*direction, "a vector of two numbers, [dx, dy]", false);
    if (!pair) return std::nullopt;
    if (pair->isZero(0)) direction->fault("must not be zero: it points from the body to the foundation");
    contact.direction = *pair;
  }
  return contact;
}

const Names<ReadCondition> membrane_conditions{
    {"fixed", read_value<Fixed>}, {"traction", read_traction}, {"contact", read_contact}};
const Names<ReadCondition> elastic_conditions{{"fixed", read_value<Fixed>},
                                              {"roller", read_roller},
                                              {"traction", read_traction},
                                              {"contact", read_contact}};

std::optional<Condition> read_condition(const Value& value, Model model) {
  const auto object = value.object();
  if (!object) return std::nullopt;
  const auto& conditions = model == Model::membrane ? membrane_conditions : elastic_conditions;
  const auto member = object->require("type", "the condition: " + list_of(only_names(conditions)));
  const auto read = member ? member->one_of(conditions) : std::nullopt;
  if (!read) {
    object->allow({"type", "value", "pressure", "gap", "direction"}, "a boundary condition");
    return std::nullopt;
  }
  return (*read)(*object, model);
}

void check_names(const Value& boundary, const std::vector<std::string>& parts) {
  std::vector<std::string_view> known(parts.begin(), parts.end());
  known.push_back(every_other_part);
  const std::set<std::string_view> sorted(known.begin(), known.end());
  for (const auto& [part, condition] : boundary.json().items()) {
    if (boundary.faults().is_full()) return;
    if (sorted.contains(part)) continue;
    boundary.faults().add(pointer_to(boundary.pointer(), part), "the domain has no part " + in_quotes(part) +
                                                                    suggestion(part, known) +
                                                                    "; known are: " + list_of(known));
  }
}

}  // namespace

std::map<std::string, Condition> read_conditions(const Value& value, Model model) {
  std::map<std::string, Condition> conditions;
  const auto object = value.object();
  if (!object) return conditions;
  if (const std::size_t count = value.json().size(); count > limits::parts) {
    value.fault("must have at most " + std::to_string(limits::parts) + " conditions; it has " +
                std::to_string(count));
    return conditions;
  }
  for (const auto& [part, member] : object->members())
    if (const auto condition = read_condition(member, model)) conditions.emplace(part, *condition);
  return conditions;
}

std::map<std::string, Condition> read_boundary(const Value& value, Model model, const Domain& domain) {
  // A rectangle has its parts whatever its size; any other domain with a fault has none that a name could be
  // held against.
  const bool is_rectangle =
      std::holds_alternative<Rectangle>(domain) && !value.faults().has_any_at("/domain/type");
  const bool known = is_rectangle || !value.faults().has_any_at("/domain");
  const std::vector<std::string> parts = known ? part_names(domain) : std::vector<std::string>{};
  if (known && value.json().is_object()) check_names(value, parts);
  std::map<std::string, Condition> conditions = read_conditions(value, model);
  // insert() leaves the parts alone that have a condition of their own.
  if (const auto rest = conditions.extract(std::string(every_other_part)); !rest.empty())
    for (const std::string& part : parts) conditions.insert({part, rest.mapped()});
  return conditions;
}

}  // namespace signorini::api
