#include <algorithm>

#include "api/document/json_pointer.hpp"
#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

/// `what` the names are of, such as `scheme`.
template <typename T>
std::vector<T> read_different(const Value& value, const Names<T>& names, const std::string& what) {
  std::vector<T> all;
  value.for_each("an array of " + what + "s: " + list_of(only_names(names)), [&](const Value& entry) {
    const auto named = entry.one_of(names);
    if (!named) return;
    if (std::ranges::find(all, *named) != all.end()) entry.fault("is there twice");
    all.push_back(*named);
  });
  if (value.json().is_array() && value.json().empty()) value.fault("must have at least one " + what);
  return all;
}

std::vector<Field> read_stress(const Value& value, Model model) {
  const bool membrane = model == Model::membrane;
  const auto entries = membrane ? value.elements(2, "an array of two numbers or expressions, [qx, qy]")
                                : value.elements(3, "an array of three numbers or expressions, [xx, yy, xy]");
  std::vector<Field> stress;
  if (entries)
    for (const Value& entry : *entries)
      stress.push_back(read_field(entry, Variables::interior).value_or(Field()));
  return stress;
}

Exact read_exact(const Value& value, Model model) {
  Exact exact;
  const auto object = value.object();
  if (!object) return exact;
  object->allow({"displacement", "stress", "energy"}, "an exact solution");
  if (const auto displacement = object->find("displacement"))
    exact.displacement = read_vector_field(*displacement, model, Variables::interior);
  if (const auto stress = object->find("stress")) exact.stress = read_stress(*stress, model);
  if (const auto energy = object->find("energy")) exact.energy = energy->number();
  return exact;
}

/// The document's mesh, to which a study gives another fineness.
json base_mesh(const Object& document) {
  const auto mesh = document.find("mesh");
  return mesh ? mesh->json() : json::object();
}

/// How a member of the study that lists meshes gives an entry to the mesh.
using SetFineness = void (*)(json& mesh, const json& entry);

const Names<SetFineness> finenesses{
    {"divisions",
     [](json& mesh, const json& entry) {
       mesh.erase("size");
       mesh["divisions"] = entry.is_number() ? json{entry, entry} : entry;
     }},
    {"sizes",
     [](json& mesh, const json& entry) {
       mesh.erase("divisions");
       mesh["size"] = entry;
     }},
    {"refine", [](json& mesh, const json& entry) { mesh["refine"] = entry; }}};

/// The mesh without what is wrong with it: all of that is the entry's fault, for the document's own mesh is
/// sound.
StudyMesh read_entry(const Value& entry, json mesh, SetFineness set_fineness, const Problem& problem) {
  mesh.erase("adaptive");
  set_fineness(mesh, entry.json());
  Faults faults;
  StudyMesh read{entry.pointer(), read_mesh(Value(mesh, "", faults), problem.domain)};
  try {
    faults.throw_if_any();
  } catch (const InvalidProblem& invalid) {
    entry.fault(invalid.faults().front().detail);
  }
  return read;
}

StudyMesh read_adaptive(const Value& value, json mesh, const Value& study, const Problem& problem) {
  mesh["adaptive"] = value.json();
  return {value.pointer(), read_mesh(Value(mesh, study.pointer(), value.faults()), problem.domain)};
}

std::size_t sides_of(const Domain& domain) {
  const auto* polygon = std::get_if<Polygon>(&domain);
  return polygon ? polygon->vertex_count() : 0;
}

std::vector<StudyMesh> read_meshes(const Value& value, const Object& study, const Object& document,
                                   const Problem& problem) {
  const json mesh = base_mesh(document);
  if (const auto adaptive = study.find("adaptive")) return {read_adaptive(*adaptive, mesh, value, problem)};
  std::vector<StudyMesh> meshes;
  for (const auto& [name, set_fineness] : finenesses)
    if (const auto member = study.find(name)) {
      const std::vector<Value> entries = member->list("an array of meshes", limits::study_meshes);
      if (member->json().is_array() && member->json().empty()) member->fault("must have at least one entry");
      if (const std::size_t pairs = entries.size() * problem.mesh.sizes.size() * sides_of(problem.domain);
          pairs > limits::study_local_sizes) {
        member->fault("makes " + std::to_string(entries.size()) + " meshes with " +
                      std::to_string(problem.mesh.sizes.size()) + " local sizes and " +
                      std::to_string(sides_of(problem.domain)) + " sides each; multiplied, these may be " +
                      std::to_string(limits::study_local_sizes) + ": take fewer of one of them");
        continue;
      }
      for (const Value& entry : entries) meshes.push_back(read_entry(entry, mesh, set_fineness, problem));
    }
  return meshes;
}

/// Whether there is exactly one member that says what the meshes are.
bool has_meshes(const Value& value, const Object& study) {
  std::vector<std::string_view> names = only_names(finenesses);
  names.push_back("adaptive");
  const auto given = std::ranges::count_if(names, [&](auto name) { return study.find(name).has_value(); });
  if (given != 1) value.fault("must have exactly one of " + list_of(names) + ": the meshes to solve on");
  return given == 1;
}

}  // namespace

Study read_study(const Value& value, const Object& document, const Problem& problem) {
  Study study;
  const bool sound_before = !value.faults().has_any_at("");
  const auto object = value.object();
  if (!object) return study;
  object->allow({"schemes", "divisions", "sizes", "refine", "adaptive", "exact", "check"}, "a study");
  const auto schemes = object->find("schemes");
  study.schemes = schemes ? read_different(*schemes, scheme_names, "scheme") : std::vector{problem.scheme};
  const Model model = components(problem.material) == 1 ? Model::membrane : Model::elasticity;
  if (const auto exact = object->find("exact")) study.exact = read_exact(*exact, model);
  if (const auto check = object->find("check"))
    study.checks_inf_sup = !read_different(*check, study_check_names, "check").empty();
  // What is wrong with the document's mesh would be wrong with every mesh again.
  if (has_meshes(value, *object) && sound_before)
    study.meshes = read_meshes(value, *object, document, problem);
  return study;
}

}  // namespace signorini::api
