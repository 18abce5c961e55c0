#include "fem/couple.hpp"

#include "fem/quadrature.hpp"

namespace signorini {

double couple_of_traction(const TractionField& traction, const Mesh& mesh, int edge) {
  const auto& [a, b] = mesh.edges[edge];
  const Vector way = mesh.points[b] - mesh.points[a];
  double couple = 0;
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    const Vector arm = turned_left((s - 0.5) * way);
    couple += edge_rule().weights[q] * (arm.x() * traction(edge, 0, s) + arm.y() * traction(edge, 1, s));
  }
  return couple * way.norm();
}

}  // namespace signorini
