#include <algorithm>
#include <cmath>

#include "contact/rigid_motions.hpp"
#include "data_check.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/mesh_sizes.hpp"
#include "mesh/refine.hpp"
#include "problem/fields.hpp"
#include "requested_mesh.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

/// Without its formula, of which the solve encloses all values at great length. Where there is no value it
/// does not count: the solve asks in other points.
Field sampled(const Field& field) {
  if (!field.formula()) return field;
  const auto value = [formula = *field.formula()](const Point& x, const Vector& normal) {
    const double own = formula(x.x(), x.y(), normal.x(), normal.y());
    return std::isfinite(own) ? own : 0;
  };
  return Field(value, field.name());
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

std::vector<std::string> look_ahead(const Problem& problem, const std::vector<Variation>& sweep) {
  MeshRequest start = problem.mesh;
  start.adaptive.reset();
  // A polygon's triangles are known when it is meshed.
  const bool is_polygon = std::holds_alternative<Polygon>(problem.domain);
  const auto count = [&](const MeshSizes& sizes) { return refined(sizes, start.refine).triangles; };
  if (problem.mesh.adaptive && !is_polygon)
    require_room(*problem.mesh.adaptive, count(PredictedSizes(problem.domain)(start)));
  const std::optional<Mesh> small =
      brings_large_mesh(problem.domain) ? std::nullopt : make_small_mesh(problem.domain, start);
  if (!small || count(sizes_of(*small)) > few_triangles)
    return {"the mesh is too large to be looked at, of more than " + std::to_string(few_triangles) +
            " triangles and edges of the boundary: whether formulas have sound values on it, whether "
            "means are over places in the body, and whether it can come to rest, the solve will tell"};
  const Mesh mesh = stabilized(problem, refine(*small, start.refine));
  if (problem.mesh.adaptive)
    require_room(*problem.mesh.adaptive, static_cast<std::int64_t>(mesh.triangles.size()));
  constexpr double most_steps = 1e6;
  DataCheck check = check_data(problem, sweep, mesh, most_steps, nullptr);
  if (!check.faults.empty()) throw InvalidProblem(std::move(check.faults));
  std::vector<std::string> left;
  if (!check.is_complete)
    left.push_back(
        "the formulas are so long, or so many, that they were tried in some points of the mesh only: "
        "whether they have sound values in all, the solve will tell");
  constexpr double long_formula = 60;
  if (longest_formula(problem.body) > long_formula || steps_on_boundary(problem, mesh) > most_steps)
    left.push_back(
        "the formulas of the loads are long: whether the body can come to rest, the solve will tell");
  else
    held_by_contact_alone(Discretization(with_sampled_loads(problem), mesh));
  return left;
}

}  // namespace signorini
