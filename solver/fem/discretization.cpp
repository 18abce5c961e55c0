#include "fem/discretization.hpp"

#include <limits>
#include <utility>

#include "fem/couple.hpp"
#include "fem/lagrange.hpp"

namespace signorini {

Discretization::Discretization(const Problem& posed, const Mesh& given, Progress* progress)
    : Discretization(posed, given, LoadProjection(posed, given, progress), progress) {}

Discretization::Discretization(const Problem& posed, const Mesh& given, LoadProjection projected,
                               Progress* progress, ClearanceOf of)
    : problem(posed),
      mesh(given),
      element(posed),
      body(std::move(projected)),
      traction(posed, mesh, progress),
      load(spaces().displacements(), triangles()),
      clearance(make_clearance_space(posed, mesh, std::numeric_limits<double>::infinity(), of)),
      traces(posed, mesh, clearance),
      coupling_load(Eigen::VectorXd::Zero(traces.unknowns())) {
  take_up_body_load(progress);
  take_up_traction(progress);
}

void Discretization::draw_near(double reach) {
  clearance = make_clearance_space(problem, mesh, reach);
  traces.meet(clearance);
}

/// Half of a couple acts on the rotation at each end of an edge, a third at each corner of a triangle: γ is
/// linear, and the rotation of the displacement is −γ.
void Discretization::take_up_body_load(Progress* progress) {
  if (spaces().leaves_couples()) couples.resize(triangles());
  for (int t = 0; t < triangles(); ++t) {
    if (progress) progress->check_in(t);
    const TriangleLoad own = element.load(mesh, t, body[t].balanced);
    load.col(t) = own.force;
    if (!spaces().leaves_couples()) continue;
    couples[t] = own.couple;
    for (const int point : mesh.triangles[t]) coupling_load[traces.rotation_at(point)] -= own.couple / 3;
  }
}

void Discretization::take_up_traction(Progress* progress) {
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (progress) progress->check_in(edge);
    if (!traction.acts_on(edge)) continue;
    for (int c = 0; c < spaces().components; ++c) {
      const LocalVector moments =
          mesh.length(edge) * edge_moments(spaces().order, [&](double s) { return traction(edge, c, s); });
      for (int j = 0; j <= spaces().order; ++j) coupling_load[traces.trace_at(edge, j, c)] += moments[j];
    }
    if (!spaces().leaves_couples()) continue;
    const double couple = couple_of_traction(traction, mesh, edge);
    for (const int point : mesh.edges[edge]) coupling_load[traces.rotation_at(point)] -= couple / 2;
  }
}

void contact_forces(const Discretization& discrete, const std::function<LocalVector(int triangle)>& fluxes,
                    Eigen::VectorXd& forces) {
  const int per_edge = discrete.spaces().traces_per_edge(), d = discrete.spaces().components;
  forces.setZero(static_cast<Eigen::Index>(discrete.clearance.rows.size()));
  for (const ContactEdge& contact : discrete.clearance.edges) {
    const int t = discrete.mesh.edge_triangles[contact.edge][0];
    const int first = discrete.mesh.local_edge(t, contact.edge) * per_edge;
    const LocalVector outward = fluxes(t);
    for (int j = first; j < first + per_edge; j += d) {
      // −σ_n is σ·n for the membrane.
      const double force = d == 1 ? outward[j] : -contact.direction.dot(outward.segment<2>(j));
      forces[contact.rows[discrete.traces.dof(t, j) % per_edge / d]] += force;
    }
  }
}

}  // namespace signorini
