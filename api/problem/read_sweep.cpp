#include <algorithm>

#include "api/document/json_pointer.hpp"
#include "api/limits.hpp"
#include "api/problem/operator_key.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

/// Adds a fault for every member that a sweep cannot change.
void allow_only(const Object& object, const std::vector<std::string_view>& names) {
  for (const auto& [name, member] : object.members())
    if (std::ranges::find(names, name) == names.end())
      member.fault(
          "cannot change within a sweep, all entries of which have one mesh, one scheme and conditions of "
          "the "
          "same kinds; allowed are here: " +
          list_of(names));
}

void check_conditions(const Value& value, const json& boundary) {
  const auto object = value.object();
  if (!object) return;
  for (const auto& [part, member] : object->members()) {
    if (!boundary.contains(part)) {
      member.fault("the problem itself has no condition under this name; name one there with its type");
    } else if (const auto condition = member.object()) {
      allow_only(*condition, {"value", "gap", "pressure"});
    }
  }
}

/// What may be patched: only that is looked at, no values.
void check_patch(const Value& value, const json& boundary) {
  const auto patch = value.object();
  if (!patch) return;
  allow_only(*patch, {"title", "load", "boundary", "material"});
  if (const auto conditions = patch->find("boundary")) check_conditions(*conditions, boundary);
}

/// The members of the problem that an entry may change.
struct Varied {
  const json load, boundary, material;
};

/// Reads again what the patch touches; the rest is the problem's.
Variation read_variation(const Value& patch, const Varied& posed, const Problem& problem) {
  const auto& [load, boundary, material] = posed;
  const Model model = components(problem.material) == 1 ? Model::membrane : Model::elasticity;
  Variation variation{"", problem.body, {}, load_key(patch.json())};
  const Object changes = *patch.object();
  if (const auto title = changes.find("title"); title && !title->json().is_null())
    variation.title = read_title(*title);
  if (const auto member = changes.find("load")) {
    json merged = load;
    merged.merge_patch(member->json());
    variation.body = merged.is_null() ? VectorField() : read_load(member->instead(merged), model);
  }
  if (const auto member = changes.find("material")) {
    json merged = material;
    merged.merge_patch(member->json());
    if (merged != material) {
      variation.material = std::make_shared<const Material>(read_material(member->instead(merged), model));
      variation.material_key = merged.dump();
    }
  }
  if (const auto member = changes.find("boundary")) {
    json merged = json::object();
    for (const auto& [part, change] : member->json().items()) {
      merged[part] = boundary.at(part);
      merged[part].merge_patch(change);
    }
    for (auto& [part, condition] : read_conditions(member->instead(merged), model)) {
      if (part != every_other_part)
        variation.boundary.insert_or_assign(part, condition);
      else
        for (const auto& [other, own] : problem.boundary)
          if (!boundary.contains(other)) variation.boundary.insert_or_assign(other, condition);
    }
  }
  return variation;
}

}  // namespace

std::vector<Variation> read_sweep(const Value& value, const Object& document, const Problem& problem) {
  const std::vector<Value> patches =
      value.list("an array of changes, each an object as the problem itself", limits::sweep_entries);
  if (value.json().is_array() && value.json().empty()) value.fault("must have at least one entry");
  const auto boundary = document.find("boundary"), load = document.find("load"),
             material = document.find("material");
  if (!boundary || !boundary->json().is_object()) return {};
  if (patches.size() * problem.boundary.size() > limits::sweep_conditions)
    value.fault("has " + std::to_string(patches.size()) + " entries with " +
                std::to_string(problem.boundary.size()) + " conditions each; together they may have " +
                std::to_string(limits::sweep_conditions) +
                ": split the sweep, or give several edges one part");
  for (const Value& patch : patches) {
    if (value.faults().is_full()) break;
    check_patch(patch, boundary->json());
  }
  // What is wrong already would be wrong in every entry again.
  std::vector<Variation> sweep;
  if (value.faults().has_any_at("")) return sweep;
  const Varied posed{load ? load->json() : json(), boundary->json(), material ? material->json() : json()};
  sweep.reserve(patches.size());
  for (const Value& patch : patches) {
    if (value.faults().is_full()) break;
    sweep.push_back(read_variation(patch, posed, problem));
  }
  return sweep;
}

}  // namespace signorini::api
