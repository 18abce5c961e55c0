#include "fem/traction_field.hpp"

namespace signorini {

TractionField::TractionField(const Problem& problem, const Mesh& mesh) : mesh_(mesh) {
  for (const BoundaryPart& part : mesh.boundary) {
    const auto found = problem.boundary.find(part.name);
    if (found == problem.boundary.end()) continue;
    if (std::holds_alternative<Traction>(found->second) || std::holds_alternative<Pressure>(found->second))
      for (const int edge : part.edges) conditions_[edge] = &found->second;
  }
}

double TractionField::operator()(int edge, int component, double s) const {
  const auto& [a, b] = mesh_.edges[edge];
  const Point x = mesh_.points[a] + s * (mesh_.points[b] - mesh_.points[a]);
  const Vector normal = mesh_.outward_normal(edge);
  const Condition& condition = *conditions_.at(edge);
  if (const auto* traction = std::get_if<Traction>(&condition)) return traction->value(component, x, normal);
  return -std::get<Pressure>(condition).value(x, normal) * normal[component];
}

}  // namespace signorini
