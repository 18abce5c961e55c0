#include <algorithm>

#include "api/json_pointer.hpp"
#include "api/operator_key.hpp"
#include "api/problem_members.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

constexpr std::size_t most_entries = 10'000;
constexpr std::size_t longest_title = 200;

/// Adds a fault for every member that a sweep cannot change.
void allow_only(const Object& object, const std::vector<std::string_view>& names) {
  for (const auto& [name, member] : object.members())
    if (std::ranges::find(names, name) == names.end())
      member.fault(
          "cannot change within a sweep, which solves every entry by one operator: that depends on "
          "all but the loads, gaps and boundary values; allowed are here: " +
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
  allow_only(*patch, {"title", "load", "boundary"});
  if (const auto conditions = patch->find("boundary")) check_conditions(*conditions, boundary);
}

Variation read_variation(const Value& patch, const json& load, const json& boundary, const Problem& problem) {
  const Model model = components(problem.material) == 1 ? Model::membrane : Model::elasticity;
  json merged{{"load", load}, {"boundary", boundary}};
  merged.merge_patch(patch.json());
  const auto member = [&](const char* name) {
    return Value(merged[name], pointer_to(patch.pointer(), name), patch.faults());
  };
  Variation variation;
  if (merged.contains("title")) variation.title = read_title(member("title"));
  if (merged.contains("load") && !merged["load"].is_null()) variation.body = read_load(member("load"), model);
  variation.boundary = read_boundary(member("boundary"), model, problem.domain);
  variation.load_key = load_key(merged.value("load", json()), merged["boundary"]);
  return variation;
}

}  // namespace

std::string read_title(const Value& value) {
  return value.text(longest_title).value_or("");
}

std::vector<Variation> read_sweep(const Value& value, const Object& document, const Problem& problem) {
  const std::vector<Value> patches = value.list("an array of changes, each an object as the problem itself");
  if (value.json().is_array() && (patches.empty() || patches.size() > most_entries))
    value.fault("must have 1 to " + std::to_string(most_entries) + " entries; it has " +
                std::to_string(patches.size()));
  const auto boundary = document.find("boundary"), load = document.find("load");
  if (!boundary || !boundary->json().is_object()) return {};
  for (const Value& patch : patches) check_patch(patch, boundary->json());
  // What is wrong already would be wrong in every entry again.
  std::vector<Variation> sweep;
  if (value.faults().has_any_at("")) return sweep;
  for (const Value& patch : patches)
    sweep.push_back(read_variation(patch, load ? load->json() : json(), boundary->json(), problem));
  return sweep;
}

}  // namespace signorini::api
