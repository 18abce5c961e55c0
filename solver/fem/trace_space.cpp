#include "fem/trace_space.hpp"

#include "fem/lagrange.hpp"

namespace signorini {
namespace {

/// ∫ value φ_j along an edge from its first to its second point, divided by its length.
template <typename Value>
LocalVector moments_of(const Value& value, const Mesh& mesh, int edge, int order) {
  return edge_moments(order, [&](double s) {
    const auto [x, normal] = mesh.on_boundary(edge, s);
    return value(x, normal);
  });
}

}  // namespace

TraceSpace::TraceSpace(const Problem& problem, const Mesh& mesh, const ClearanceSpace& clearance)
    : mesh_(mesh),
      components_(components(problem.material)),
      order_(spaces_of(problem.scheme, components_).order),
      per_edge_(spaces_of(problem.scheme, components_).traces_per_edge()),
      rotations_(spaces_of(problem.scheme, components_).rotations()),
      contact_(clearance.unknowns),
      dofs_(mesh.edges.size() * per_edge_ + (rotations_ ? mesh.points.size() : 0), CouplingDof{0, 1, 0}),
      turned_(mesh.edges.size(), -1) {
  number_triangles();
  for (const BoundaryPart& part : mesh.boundary) {
    if (const auto* fixed = condition_on<Fixed>(problem, part.name)) fix(part, fixed->value);
    if (const auto* roller = condition_on<Roller>(problem, part.name)) roll(part, roller->motion);
  }
  reserve_contact(clearance);
  for (CouplingDof& dof : dofs_)
    if (dof.unknown >= 0) dof.unknown = free_++;
  meet(clearance);
}

void TraceSpace::turn(int edge, const Vector& direction) {
  turned_[edge] = static_cast<int>(directions_.size());
  directions_.push_back(direction);
}

void TraceSpace::fix(const BoundaryPart& part, const VectorField& value) {
  for (const int edge : part.edges)
    for (int c = 0; c < components_; ++c) {
      const auto component = [&](const Point& x, const Vector& normal) { return value(c, x, normal); };
      const LocalVector datum = project_onto_edge(order_, moments_of(component, mesh_, edge, order_));
      for (int j = 0; j <= order_; ++j) at(edge, j, c) = {-1, 1, datum[j]};
    }
}

void TraceSpace::roll(const BoundaryPart& part, const SupportMotion& motion) {
  for (const int edge : part.edges) {
    const Vector normal = mesh_.outward_normal(edge);
    const auto& [a, b] = mesh_.edges[edge];
    turn(edge, normal);
    for (int j = 0; j <= order_; ++j) {
      const Point x =
          order_ == 0 ? Point((mesh_.points[a] + mesh_.points[b]) / 2) : mesh_.points[j == 0 ? a : b];
      at(edge, j, 0) = {-1, 1, motion(x).dot(normal)};
    }
  }
}

/// The normal components on Γ_C are no free unknowns.
void TraceSpace::reserve_contact(const ClearanceSpace& clearance) {
  for (const ContactEdge& contact : clearance.edges) {
    if (components_ == 2) turn(contact.edge, contact.direction);
    for (int j = 0; j <= order_; ++j) at(contact.edge, j, 0).unknown = -1;
  }
}

void TraceSpace::meet(const ClearanceSpace& clearance) {
  const int sign = components_ == 1 ? 1 : -1;  // of λ in m: u_n = −u for the membrane
  for (const ContactEdge& contact : clearance.edges)
    for (int j = 0; j <= order_; ++j) {
      const ClearanceRow& row = clearance.rows[contact.rows[j]];
      const bool held = row.unknown < 0;
      at(contact.edge, j, 0) = {held ? -1 : free_ + row.unknown, sign,
                                sign * ((held ? row.datum : 0) - contact.gap[j])};
    }
}

void TraceSpace::number_triangles() {
  triangle_dofs_.reserve(mesh_.triangles.size() * dofs_per_triangle());
  for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t)
    for (int j = 0; j < dofs_per_triangle(); ++j) triangle_dofs_.push_back(dof_of(t, j));
}

int TraceSpace::dof_of(int triangle, int local) const {
  if (local >= traces_per_triangle())
    return first_rotation() + mesh_.triangles[triangle][local - traces_per_triangle()];
  const int e = local / per_edge_, function = local % per_edge_ / components_,
            component = local % components_;
  const int edge = mesh_.triangle_edges[triangle][e];
  const int point = mesh_.triangles[triangle][(e + 1 + function) % 3];
  const bool reversed = order_ == 1 && (point == mesh_.edges[edge][0]) != (function == 0);
  return edge * per_edge_ + (reversed ? 1 - function : function) * components_ + component;
}

bool TraceSpace::is_turned(int triangle) const {
  const auto& [a, b, c] = mesh_.triangle_edges[triangle];
  return turned_[a] >= 0 || turned_[b] >= 0 || turned_[c] >= 0;
}

LocalMatrix TraceSpace::to_xy(int triangle) const {
  LocalMatrix map = LocalMatrix::Identity(dofs_per_triangle(), dofs_per_triangle());
  for (int e = 0; e < 3; ++e) {
    const int turned = turned_[mesh_.triangle_edges[triangle][e]];
    if (turned < 0) continue;
    const Vector& n = directions_[turned];
    for (int j = 0; j <= order_; ++j) {
      const int first = e * per_edge_ + 2 * j;
      map.block<2, 2>(first, first) << n.x(), -n.y(), n.y(), n.x();
    }
  }
  return map;
}

Eigen::VectorXd TraceSpace::rotation(const Eigen::VectorXd& x) const {
  Eigen::VectorXd rotation(dofs_.size() - first_rotation());
  for (int p = 0; p < rotation.size(); ++p) rotation[p] = x[rotation_at(p)];
  return rotation;
}

LocalVector TraceSpace::values(int triangle, const Eigen::VectorXd& x) const {
  LocalVector values(dofs_per_triangle());
  for (int j = 0; j < values.size(); ++j) {
    const CouplingDof& own = dofs_[dof(triangle, j)];
    values[j] = own.datum + own.part_of(x);
  }
  return in_xy(triangle, values);
}

LocalVector TraceSpace::changes(int triangle, const Eigen::VectorXd& dx) const {
  LocalVector changes(dofs_per_triangle());
  for (int j = 0; j < changes.size(); ++j) changes[j] = dofs_[dof(triangle, j)].part_of(dx);
  return in_xy(triangle, changes);
}

LocalVector TraceSpace::in_xy(int triangle, const LocalVector& own) const {
  return is_turned(triangle) ? LocalVector(to_xy(triangle) * own) : own;
}

}  // namespace signorini
