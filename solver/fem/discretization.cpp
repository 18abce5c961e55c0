#include "fem/discretization.hpp"

namespace signorini {
namespace {

Eigen::MatrixXd loads(const Element& element, const Mesh& mesh) {
  Eigen::MatrixXd load(element.spaces().displacements(), mesh.triangles.size());
  for (int t = 0; t < static_cast<int>(load.cols()); ++t) load.col(t) = element.load(mesh, t);
  return load;
}

}  // namespace

Discretization::Discretization(const Problem& posed, const Mesh& given)
    : problem(posed),
      mesh(given),
      element(posed),
      load(loads(element, mesh)),
      clearance(make_clearance_space(posed, mesh)),
      traces(posed, mesh, clearance) {}

Eigen::VectorXd contact_forces(const Discretization& problem,
                               const std::function<LocalVector(int triangle)>& fluxes) {
  const int per_edge = problem.spaces().traces_per_edge(), d = problem.spaces().components;
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(problem.clearance.rows.size());
  for (const ContactEdge& contact : problem.clearance.edges) {
    const int t = problem.mesh.edge_triangles[contact.edge][0];
    const int first = problem.mesh.local_edge(t, contact.edge) * per_edge;
    const LocalVector outward = fluxes(t);
    for (int j = first; j < first + per_edge; j += d) {
      // −σ_n is σ·n for the membrane.
      const double force = d == 1 ? outward[j] : -contact.direction.dot(outward.segment<2>(j));
      forces[contact.rows[problem.traces.dof(t, j) % per_edge / d]] += force;
    }
  }
  return forces;
}

}  // namespace signorini
