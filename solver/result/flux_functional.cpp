#include "flux_functional.hpp"

#include "fem/couple.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

/// The first of the fluxes of an edge in its triangle.
int first_flux(const Discretization& discrete, int triangle, int edge) {
  return discrete.mesh.local_edge(triangle, edge) * discrete.spaces().traces_per_edge();
}

int triangle_at(const Discretization& discrete, int edge) {
  return discrete.mesh.edge_triangles[edge][0];
}

}  // namespace

double FluxFunctional::operator()(const Discretization& discrete, const Eigen::MatrixXd& stress) const {
  double sum = constant;
  for (const auto& [edge, weights] : edges) {
    const int t = triangle_at(discrete, edge);
    sum += weights.dot(stress.col(t).segment(first_flux(discrete, t, edge), weights.size()));
  }
  return sum;
}

std::vector<FluxFunctional> reactions_on(const Discretization& discrete, const BoundaryPart& part) {
  const int d = discrete.spaces().components, order = discrete.spaces().order;
  std::vector<FluxFunctional> reactions(d == 1 ? 1 : 3);
  const TractionField& traction = discrete.traction;
  for (const int edge : part.edges) {
    const int t = triangle_at(discrete, edge), e = discrete.mesh.local_edge(t, edge);
    const auto corners = discrete.mesh.corners(t);
    const Point &a = corners[(e + 1) % 3], &b = corners[(e + 2) % 3];
    LocalVector force[2], moment = LocalVector::Zero(d * (order + 1));
    for (LocalVector& weights : force) weights = moment;
    for (int j = 0; j <= order; ++j) {
      for (int c = 0; c < d; ++c) force[c][j * d + c] = 1;
      const Point x = order == 0 ? Point((a + b) / 2) : (j == 0 ? a : b);
      if (d == 2) moment.segment<2>(2 * j) << -x.y(), x.x();
    }
    for (int c = 0; c < d; ++c) reactions[c].edges.push_back({edge, force[c]});
    if (d == 2) reactions[2].edges.push_back({edge, moment});
    if (discrete.spaces().leaves_couples() && traction.acts_on(edge))
      reactions[2].constant += couple_of_traction(traction, discrete.mesh, edge);
  }
  return reactions;
}

FluxFunctional contact_force_on(const Discretization& discrete, int row) {
  const int d = discrete.spaces().components, per_edge = discrete.spaces().traces_per_edge();
  FluxFunctional force;
  for (const ContactEdge& contact : discrete.clearance.edges) {
    const int t = triangle_at(discrete, contact.edge), first = first_flux(discrete, t, contact.edge);
    LocalVector weights = LocalVector::Zero(per_edge);
    for (int j = 0; j < per_edge; j += d) {
      if (contact.rows[discrete.traces.dof(t, first + j) % per_edge / d] != row) continue;
      // −σ_n is σ·n for the membrane.
      if (d == 1)
        weights[j] = 1;
      else
        weights.segment<2>(j) = -contact.direction;
    }
    if (!weights.isZero(0)) force.edges.push_back({contact.edge, weights});
  }
  return force;
}

Eigen::VectorXd response(const FluxFunctional& functional, const Discretization& discrete,
                         const Operator& made, Factor::Workspace& workspace, Progress& progress) {
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(discrete.traces.unknowns());
  for (const auto& [edge, weights] : functional.edges) {
    const int t = triangle_at(discrete, edge);
    LocalVector coupling = LocalVector::Zero(discrete.traces.dofs_per_triangle());
    coupling.segment(first_flux(discrete, t, edge), weights.size()) = weights;
    add_forces(discrete, t, coupling, forces);
  }
  return made.factor().condense(forces, workspace, progress).trailing;
}

}  // namespace signorini
