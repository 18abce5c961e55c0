#include "certify/traction_work.hpp"

#include <cmath>

#include "fem/quadrature.hpp"

namespace signorini {

TractionWork work_of_traction(const Discretization& discrete, const AdmissibleDisplacement& v,
                              const std::vector<int>& owners) {
  const Mesh& mesh = discrete.mesh;
  TractionWork sum;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    const int t = mesh.edge_triangles[edge][0];
    if (!discrete.traction.acts_on(edge) || owners[t] < 0) continue;
    sum.slack += discrete.traction[edge].uncertain_work * v.largest_on(t);
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const Eigen::VectorXd value = v.on_edge(edge, s);
      for (int c = 0; c < value.size(); ++c) {
        const double own =
            edge_rule().weights[q] * mesh.length(edge) * discrete.traction(edge, c, s) * value[c];
        sum.value += own;
        sum.size += std::abs(own);
      }
    }
  }
  return sum;
}

}  // namespace signorini
