#include <algorithm>

#include "contact/rigid_motions.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/mesh_sizes.hpp"
#include "mesh/refine.hpp"
#include "problem/fields.hpp"
#include "requested_mesh.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

/// Without its formula, of which the solve encloses all values at great length.
Field sampled(const Field& field) {
  if (!field.formula()) return field;
  return Field([field](const Point& x, const Vector& normal) { return field(x, normal); }, field.name());
}

VectorField sampled(const VectorField& field) {
  if (field.size() == 0) return field;
  return field.size() == 1 ? VectorField(sampled(field.fields()[0]))
                           : VectorField(sampled(field.fields()[0]), sampled(field.fields()[1]));
}

/// The problem with functions for the formulas of its loads.
Problem with_sampled_loads(Problem problem) {
  problem.body = sampled(problem.body);
  for (auto& [part, condition] : problem.boundary) {
    if (auto* traction = std::get_if<Traction>(&condition)) traction->value = sampled(traction->value);
    if (auto* pressure = std::get_if<Pressure>(&condition)) pressure->value = sampled(pressure->value);
  }
  return problem;
}

/// The longest formula that is evaluated all over the mesh.
double longest_formula(const VectorField& body) {
  double longest = 0;
  for (const Field& field : body.fields()) longest = std::max(longest, steps_of({&field}));
  return longest;
}

}  // namespace

void require_rest(const Problem& problem) {
  constexpr double long_formula = 60;
  if (longest_formula(problem.body) > long_formula) return;
  MeshRequest start = problem.mesh;
  start.adaptive.reset();
  // A polygon's triangles are known when it is meshed.
  const bool is_polygon = std::holds_alternative<Polygon>(problem.domain);
  const auto count = [&](const MeshSizes& sizes) { return refined(sizes, start.refine).triangles; };
  if (problem.mesh.adaptive && !is_polygon)
    require_room(*problem.mesh.adaptive, count(PredictedSizes(problem.domain)(start)));
  const std::optional<Mesh> small = make_small_mesh(problem.domain, start);
  if (!small || count(sizes_of(*small)) > few_triangles) return;
  const Mesh mesh = stabilized(problem, refine(*small, start.refine));
  if (problem.mesh.adaptive)
    require_room(*problem.mesh.adaptive, static_cast<std::int64_t>(mesh.triangles.size()));
  const Problem cheap = with_sampled_loads(problem);
  held_by_contact_alone(Discretization(cheap, mesh));
}

}  // namespace signorini
