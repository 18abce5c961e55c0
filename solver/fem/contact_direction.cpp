#include "fem/contact_direction.hpp"

namespace signorini {

Vector contact_direction(const Mesh& mesh, const BoundaryPart& part, const Contact& contact, int edge) {
  const Vector normal = mesh.outward_normal(edge), direction = contact.unit_direction(normal);
  constexpr double rounding = 1e-9;
  if (!(direction.dot(normal) > rounding)) {
    const Point middle = (mesh.points[mesh.edges[edge][0]] + mesh.points[mesh.edges[edge][1]]) / 2;
    throw InvalidProblem({{"/boundary/" + part.name + "/direction",
                           "must point out of the body, from it to the foundation; at " + to_string(middle) +
                               " it does not: turn it, or give the edges on that side another condition"}});
  }
  return direction;
}

}  // namespace signorini
