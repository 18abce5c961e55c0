#include "certify/data/lost_digits.hpp"

#include <algorithm>
#include <cmath>

#include "formula/rounding.hpp"
#include "problem/fields.hpp"

namespace signorini {
namespace {

/// Of the value, or of the displacement: more is not rounding (THEORY.md, "Assumptions").
constexpr double kDigits = 1e-10;

bool has_digits(const Field& field, const Point& x, const Vector& n, double scale) {
  const double rounding = rounding_of(*field.formula(), x.x(), x.y(), n.x(), n.y());
  return !(rounding > kDigits * std::max(scale, std::abs(field(x, n))));
}

/// What the fields of a law are measured by: Poisson's ratio by 1, an entry of a tensor by the largest.
double scale_of(const Material& material, const Field& field, const Point& x) {
  if (const auto* isotropic = std::get_if<YoungPoisson>(&material))
    return &field == &isotropic->poisson ? 1 : 0;
  double most = 0;
  for (const Field* entry : fields_of(material)) most = std::max(most, std::abs((*entry)(x)));
  return most;
}

std::string reason(const Field& field, const Point& x) {
  return field.name() + " is a difference of numbers so large that rounding leaves it too few digits near " +
         to_string(x) + ": write it without them";
}

}  // namespace

std::vector<std::string> lost_digits(const Discretization& discrete, double displacement,
                                     Progress& progress) {
  const Mesh& mesh = discrete.mesh;
  std::vector<std::string> all;
  const Material& material = discrete.problem.material;
  const Vector none = Vector::Zero();
  for (const Field* field : fields_of(material)) {
    if (!field->formula()) continue;
    for (int t = 0; t < discrete.triangles(); ++t) {
      progress.check_in(t);
      const Point x = mesh.centroid(t);
      if (has_digits(*field, x, none, 0) || has_digits(*field, x, none, scale_of(material, *field, x)))
        continue;
      all.push_back(reason(*field, x));
      break;
    }
  }
  for (const BoundaryPart& part : mesh.boundary) {
    const auto condition = discrete.problem.boundary.find(part.name);
    if (condition == discrete.problem.boundary.end()) continue;
    const bool is_carried = std::holds_alternative<Traction>(condition->second) ||
                            std::holds_alternative<Pressure>(condition->second);
    if (is_carried) continue;
    for (const Field* field : fields_of(condition->second)) {
      if (!field->formula()) continue;
      const auto lacks = [&](int edge) {
        const auto [x, n] = mesh.on_boundary(edge, 0.5);
        return !has_digits(*field, x, n, displacement);
      };
      const auto found = std::ranges::find_if(part.edges, lacks);
      if (found != part.edges.end()) all.push_back(reason(*field, mesh.on_boundary(*found, 0.5).x));
    }
  }
  return all;
}

}  // namespace signorini
