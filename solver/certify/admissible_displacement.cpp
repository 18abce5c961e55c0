#include "certify/admissible_displacement.hpp"

#include <algorithm>
#include <cmath>

#include "certify/potential.hpp"
#include "certify/relaxation.hpp"

namespace signorini {
namespace {

/// Below this part of the displacement a difference is rounding.
constexpr double kRounding = 1e-12;

Eigen::VectorXd value_of(const VectorField& field, int components, const Point& x, const Vector& normal) {
  Eigen::VectorXd value(components);
  for (int c = 0; c < components; ++c) value[c] = field(c, x, normal);
  return value;
}

/// Two of the directions differ, but by little, as on a polygon that stands for a curve: to touch in both
/// would fix the point along the curve too, which is so in the corner itself but not near it.
bool turns_slightly(const std::vector<PointConstraint>& constraints) {
  return std::ranges::any_of(constraints, [&](const PointConstraint& constraint) {
    if (constraint.direction.size() == 1) return false;
    const Vector one = constraint.direction, other = constraints[0].direction;
    return one.dot(other) > 0.9 && !is_same_direction(one, other);
  });
}

}  // namespace

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& problem, const Solution& solution,
                                               const Eigen::VectorXd& coupling)
    : problem_(problem),
      components_(problem.spaces().components),
      clearance_(problem.clearance.clearance(coupling.tail(problem.traces.contact_unknowns()))),
      points_(displacement_at_corners(problem, solution)),
      scale_(points_.cwiseAbs().maxCoeff()) {
  constrain_points();
  set_middles(coupling);
  for (const BoundaryPart& part : problem.mesh.boundary) {
    if (const auto* fixed = condition_on<Fixed>(problem.problem, part.name)) fix(part, *fixed);
    if (condition_on<Roller>(problem.problem, part.name)) roll(part);
  }
  for (const ContactEdge& contact : problem.clearance.edges) meet(contact);
}

void AdmissibleDisplacement::relax(const Eigen::VectorXd& work, int steps, Progress& progress) {
  const Mesh& mesh = problem_.mesh;
  QuadraticValues values(mesh);
  values.points = points_.row(0);
  values.middles = middles_.row(0);
  for (const auto& [point, value] : fixed_points_) values.held_points[point] = true;
  for (const BoundaryPart& part : mesh.boundary)
    if (condition_on<Fixed>(problem_.problem, part.name))
      for (const int edge : part.edges) values.held_middles[edge] = true;
  const auto touches = [&](const ContactEdge& contact, int k) { return clearance_[contact.rows[k]] <= 0; };
  for (const ContactEdge& contact : problem_.clearance.edges) {
    values.held_middles[contact.edge] = touches(contact, 0) && touches(contact, 1);
    for (int k = 0; k < 2; ++k)
      if (touches(contact, k)) values.held_points[mesh.edges[contact.edge][k]] = true;
  }
  signorini::relax(problem_, stiffness_of, values, work, steps, progress);
  points_.row(0) = values.points;
  middles_.row(0) = values.middles;
  for (const ContactEdge& contact : problem_.clearance.edges)
    for (int k = 0; k < 2; ++k) {
      const int point = mesh.edges[contact.edge][k];
      const double lack = -room(contact, k);
      if (lack > 0 && !values.held_points[point]) points_.col(point) -= lack * direction(contact);
    }
  for (const ContactEdge& contact : problem_.clearance.edges)
    if (!values.held_middles[contact.edge]) lower_below(contact);
}

const Lift* AdmissibleDisplacement::lift(int edge) const {
  const auto found = lifts_.find(edge);
  return found == lifts_.end() ? nullptr : &found->second;
}

bool AdmissibleDisplacement::is_lifted(int t) const {
  return std::ranges::any_of(problem_.mesh.triangle_edges[t],
                             [&](int edge) { return lift(edge) != nullptr; });
}

template <int D>
void AdmissibleDisplacement::add_lifts(int t, const Point& reference, const Eigen::Matrix2d& inverse_jacobian,
                                       Eigen::Matrix<double, D, 1>& value, Tensor<D>& slope) const {
  const Eigen::Vector3d hats(1 - reference.x() - reference.y(), reference.x(), reference.y());
  const Eigen::Matrix2d gradients = inverse_jacobian.transpose();
  const std::array<Vector, 3> hat_gradients{-gradients.rowwise().sum(), gradients.col(0), gradients.col(1)};
  for (int e = 0; e < 3; ++e) {
    const int edge = problem_.mesh.triangle_edges[t][e];
    const Lift* lifted = lift(edge);
    if (!lifted) continue;
    int a = (e + 1) % 3, b = (e + 2) % 3;
    if (problem_.mesh.triangles[t][a] != problem_.mesh.edges[edge][0]) std::swap(a, b);
    value += lifted->value(hats[a], hats[b]);
    const Eigen::Matrix2Xd gradient =
        lifted->gradient(hats[a], hats[b], hat_gradients[a], hat_gradients[b]).transpose();
    slope += gradient.reshaped();
  }
}

template void AdmissibleDisplacement::add_lifts<1>(int, const Point&, const Eigen::Matrix2d&,
                                                   Eigen::Matrix<double, 1, 1>&, Tensor<1>&) const;
template void AdmissibleDisplacement::add_lifts<2>(int, const Point&, const Eigen::Matrix2d&,
                                                   Eigen::Matrix<double, 2, 1>&, Tensor<2>&) const;

Eigen::VectorXd AdmissibleDisplacement::on_edge(int edge, double s) const {
  const auto& [a, b] = problem_.mesh.edges[edge];
  const Eigen::VectorXd quadratic = (1 - s) * (1 - 2 * s) * points_.col(a) +
                                    s * (2 * s - 1) * points_.col(b) + 4 * s * (1 - s) * middles_.col(edge);
  const Lift* lifted = lift(edge);
  return lifted ? Eigen::VectorXd(quadratic + (*lifted)(s)) : quadratic;
}

double AdmissibleDisplacement::room(const ContactEdge& contact, double s) const {
  return gap_at(contact, s) - direction(contact).dot(on_edge(contact.edge, s));
}

Point AdmissibleDisplacement::at(int edge, double s) const {
  const auto& [a, b] = problem_.mesh.edges[edge];
  return problem_.mesh.points[a] + s * (problem_.mesh.points[b] - problem_.mesh.points[a]);
}

Eigen::VectorXd AdmissibleDisplacement::direction(const ContactEdge& contact) const {
  if (components_ == 1) return Eigen::VectorXd::Constant(1, -1);
  return contact.direction;
}

double AdmissibleDisplacement::gap_at(const ContactEdge& contact, double s) const {
  const std::string& part = problem_.mesh.boundary[problem_.clearance.rows[contact.rows[0]].part].name;
  return condition_on<Contact>(problem_.problem, part)
      ->gap(at(contact.edge, s), problem_.mesh.outward_normal(contact.edge));
}

void AdmissibleDisplacement::refuse(const std::string& reason) {
  if (std::ranges::find(unmet_, reason) == unmet_.end()) unmet_.push_back(reason);
}

/// The points of Γ_D get u_D; those of Γ_C and of rollers the nearest value that their edges allow.
void AdmissibleDisplacement::constrain_points() {
  const Mesh& mesh = problem_.mesh;
  for (const BoundaryPart& part : mesh.boundary)
    if (const auto* fixed = condition_on<Fixed>(problem_.problem, part.name))
      for (const int edge : part.edges) fix_points(edge, *fixed);

  std::map<int, std::vector<PointConstraint>> constraints;
  for (const BoundaryPart& part : mesh.boundary)
    if (condition_on<Roller>(problem_.problem, part.name))
      for (const int edge : part.edges)
        for (const int point : mesh.edges[edge])
          constraints[point].push_back({mesh.outward_normal(edge), 0, true, true});
  for (const ContactEdge& contact : problem_.clearance.edges)
    for (int k = 0; k < 2; ++k) {
      const double g = gap_at(contact, k);
      scale_ = std::max(scale_, std::abs(g));
      const bool touches = clearance_[contact.rows[k]] <= 0;
      constraints[mesh.edges[contact.edge][k]].push_back({direction(contact), g, touches});
    }
  for (const auto& [point, own] : constraints) admit(point, own);
}

void AdmissibleDisplacement::fix_points(int edge, const Fixed& fixed) {
  for (const int point : problem_.mesh.edges[edge]) {
    const Eigen::VectorXd value =
        value_of(fixed.value, components_, problem_.mesh.points[point], problem_.mesh.outward_normal(edge));
    scale_ = std::max(scale_, value.lpNorm<Eigen::Infinity>());
    const auto [known, is_new] = fixed_points_.try_emplace(point, value);
    points_.col(point) = known->second;
    if (!is_new && (known->second - value).lpNorm<Eigen::Infinity>() > kRounding * scale_)
      refuse("the fixed values jump at " + to_string(problem_.mesh.points[point]));
  }
}

void AdmissibleDisplacement::admit(int point, std::vector<PointConstraint> constraints) {
  const Eigen::VectorXd v = points_.col(point);
  std::optional<Eigen::VectorXd> nearest;
  const bool is_fixed = fixed_points_.contains(point);
  if (!is_fixed && !turns_slightly(constraints)) nearest = nearest_admissible(v, constraints, scale_);
  if (!nearest) {
    for (PointConstraint& constraint : constraints) constraint.equality = constraint.is_roller;
    nearest = nearest_admissible(v, constraints, scale_);
  }
  if (!nearest || (is_fixed && (*nearest - v).norm() > 1e3 * kRounding * scale_))
    refuse("no displacement meets all conditions at " + to_string(problem_.mesh.points[point]));
  else if (!is_fixed)
    points_.col(point) = *nearest;
}

/// The mean of v_h over each edge is that of m.
void AdmissibleDisplacement::set_middles(const Eigen::VectorXd& coupling) {
  const Mesh& mesh = problem_.mesh;
  const int per_edge = problem_.spaces().traces_per_edge(), functions = per_edge / components_;
  middles_.resize(components_, mesh.edges.size());
  for (int t = 0; t < problem_.triangles(); ++t) {
    const LocalVector traces = problem_.traces.values(t, coupling);
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh.triangle_edges[t][e];
      if (mesh.edge_triangles[edge][0] != t) continue;
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(components_);
      for (int j = 0; j < per_edge; j += components_)
        mean += traces.segment(e * per_edge + j, components_) / functions;
      const auto& [a, b] = mesh.edges[edge];
      middles_.col(edge) = (6 * mean - points_.col(a) - points_.col(b)) / 4;
    }
  }
}

void AdmissibleDisplacement::fix(const BoundaryPart& part, const Fixed& fixed) {
  for (const int edge : part.edges) {
    const Vector normal = problem_.mesh.outward_normal(edge);
    const auto value = [&](double s) { return value_of(fixed.value, components_, at(edge, s), normal); };
    middles_.col(edge) = value(0.5);
    add_lift(edge, [&](double s) -> Eigen::VectorXd { return value(s) - on_edge(edge, s); });
  }
}

void AdmissibleDisplacement::roll(const BoundaryPart& part) {
  for (const int edge : part.edges) {
    const Eigen::VectorXd n = problem_.mesh.outward_normal(edge);
    middles_.col(edge) -= n.dot(middles_.col(edge)) * n;
  }
}

void AdmissibleDisplacement::meet(const ContactEdge& contact) {
  const auto& [a, b] = problem_.mesh.edges[contact.edge];
  const Eigen::VectorXd n = direction(contact);
  const auto touches = [&](int point, int k) {
    return std::abs(n.dot(points_.col(point)) - gap_at(contact, k)) <= kRounding * scale_;
  };
  const bool closed = clearance_[contact.rows[0]] <= 0 && clearance_[contact.rows[1]] <= 0;
  if (closed && touches(a, 0) && touches(b, 1))
    close(contact);
  else
    lower_below(contact);
}

/// v_n = g.
void AdmissibleDisplacement::close(const ContactEdge& contact) {
  const int edge = contact.edge;
  const Eigen::VectorXd n = direction(contact);
  middles_.col(edge) += room(contact, 0.5) * n;
  add_lift(edge, [&](double s) -> Eigen::VectorXd { return room(contact, s) * n; });
}

/// v_n ≤ g by the smallest multiple of the quadratic bubble 4 s (1 − s). The quadratic function that has the
/// values r₀ ≥ 0 and r₁ ≥ 0 at the ends and the bubble b times is nowhere negative if −4 b ≤ (√r₀ + √r₁)².
void AdmissibleDisplacement::lower_below(const ContactEdge& contact) {
  const double begin = std::max(0., room(contact, 0)), end = std::max(0., room(contact, 1));
  const double bubble = room(contact, 0.5) - (begin + end) / 2;
  const double root = std::sqrt(begin) + std::sqrt(end);
  // What a gap that is no quadratic function takes away besides, from samples with a margin.
  constexpr int samples = 32;
  constexpr double margin = 1.1;
  double taken = 0;
  for (int i = 1; i < samples; ++i) {
    const double s = 1. * i / samples, hump = 4 * s * (1 - s);
    taken = std::max(taken, (begin * (1 - s) + end * s - room(contact, s)) / hump + bubble);
  }
  const double needed = margin * taken - bubble - root * root / 4;
  if (needed > 0) middles_.col(contact.edge) -= needed * direction(contact);
}

void AdmissibleDisplacement::add_lift(int edge, const Values& d) {
  Lift lift(components_, d);
  if (lift.largest() <= kRounding * scale_) return;
  if (lift.interpolation_error() > std::max(1e-6 * lift.largest(), kRounding * scale_))
    refuse("the boundary values vary too fast for the mesh at " + to_string(at(edge, 0.5)));
  lifts_.emplace(edge, std::move(lift));
}

}  // namespace signorini
