#include "certify/displacement/admissible_displacement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "certify/displacement/displacement_relaxation.hpp"
#include "certify/displacement/gap_bubble.hpp"
#include "certify/displacement/largest_coefficient.hpp"
#include "certify/displacement/recovered_displacement.hpp"
#include "certify/displacement/relaxation.hpp"
#include "fem/edge_pieces.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

/// So many times the largest displacement is out of reach.
constexpr double kReach = 1e3;

/// None takes more than a fifth of what the others have left.
constexpr int kShares = 5;

Eigen::VectorXd value_of(const VectorField& field, int components, const Point& x, const Vector& normal) {
  Eigen::VectorXd value(components);
  for (int c = 0; c < components; ++c) value[c] = field(c, x, normal);
  return value;
}

/// Of the stiffness against changes of volume and of shape, 1 / (1 − 2ν) for an isotropic body.
double ratio_of_stiffnesses(const Material& material, const Point& x) {
  const Eigen::VectorXd compliances = eigenvalues(compliance_at(material, x));
  return compliances.maxCoeff() / compliances.minCoeff();
}

/// Two of the directions differ, but by little, as on a polygon that stands for a curve: to touch in both
/// would fix the point along the curve too, which is so in the corner itself but not near it. Not to touch
/// changes the volume beside it, and is worse where that resists much more.
bool turns_slightly(const std::vector<PointConstraint>& constraints, const Material& material,
                    const Point& x) {
  return std::ranges::any_of(constraints, [&](const PointConstraint& constraint) {
    if (constraint.direction.size() == 1) return false;
    const Vector one = constraint.direction, other = constraints[0].direction;
    const double cosine = one.dot(other);
    return cosine > 0 && one != other && (1 - cosine * cosine) * ratio_of_stiffnesses(material, x) < 0.5;
  });
}

/// The values beside an end, s = 0 or 1, do not tend to the one in it.
bool jumps_at_end(const Field& field, const EdgeLine& line, double s, double rounding) {
  const Interval values = values_at_end(field, line, s, rounding);
  return !(values.lower() <= line.value(field, s) && line.value(field, s) <= values.upper());
}

/// How far a field is from the straight line between its values at the ends of the edge, in some points.
double bend(const Field& field, const EdgeLine& line) {
  const double begin = line.value(field, 0), end = line.value(field, 1);
  double most = 0;
  for (int i = 1; i < Lift::kDegree; ++i) {
    const double s = 1. * i / Lift::kDegree;
    most = std::max(most, std::abs(line.value(field, s) - (1 - s) * begin - s * end));
  }
  return most;
}

}  // namespace

const Field& gap_on(const Discretization& discrete, const ContactEdge& contact) {
  const std::string& part = discrete.mesh.boundary[discrete.clearance.rows[contact.rows[0]].part].name;
  return condition_on<Contact>(discrete.problem, part)->gap;
}

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                                               const Eigen::VectorXd& coupling)
    : discrete_(discrete),
      components_(discrete.spaces().components),
      clearance_(discrete.clearance.clearance(coupling.tail(discrete.traces.contact_unknowns()))),
      points_(displacement_at_corners(discrete, solution)),
      scale_(points_.cwiseAbs().maxCoeff()) {}

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                                               const Eigen::VectorXd& coupling, Progress& progress)
    : AdmissibleDisplacement(discrete, solution, coupling) {
  for (std::size_t i = 0; i < discrete.clearance.rows.size(); ++i)
    clearance_[i] += discrete.clearance.rows[i].beyond;
  constrain_points();
  constrain_to_gap();
  admit_points();
  if (components_ == 2) follow_traces();
  set_middles(coupling);
  meet_supports();
  find_followed_gaps();
  CellBudget budget{kCellsOfGaps, &progress};
  lower_points(budget);
  for (const ContactEdge& contact : discrete.clearance.edges) meet(contact, budget);
}

void AdmissibleDisplacement::relax(const Eigen::VectorXd& work, int steps, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  QuadraticValues values(mesh);
  values.points = points_.row(0);
  values.middles = middles_.row(0);
  for (const auto& [point, value] : fixed_points_) values.held_points[point] = true;
  for (const BoundaryPart& part : mesh.boundary)
    if (condition_on<Fixed>(discrete_.problem, part.name))
      for (const int edge : part.edges) values.held_middles[edge] = true;
  const auto touches = [&](const ContactEdge& contact, int k) {
    return beside_.base || clearance_[contact.rows[k]] <= 0;
  };
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    values.held_middles[contact.edge] = touches(contact, 0) && touches(contact, 1);
    for (int k = 0; k < 2; ++k)
      if (touches(contact, k)) values.held_points[mesh.edges[contact.edge][k]] = true;
  }
  signorini::relax(discrete_, stiffness_of, values, work, steps, progress);
  points_.row(0) = values.points;
  middles_.row(0) = values.middles;
  if (beside_.base) return;
  for (const ContactEdge& contact : discrete_.clearance.edges)
    for (int k = 0; k < 2; ++k) {
      const int point = mesh.edges[contact.edge][k];
      const double lack = -room(contact, k);
      if (lack > 0 && !values.held_points[point]) points_.col(point) -= lack * direction(contact);
    }
  CellBudget budget{kCellsOfGaps, &progress};
  lower_points(budget);
  for (const ContactEdge& contact : discrete_.clearance.edges)
    if (!values.held_middles[contact.edge]) lower_below(contact, budget);
}

void AdmissibleDisplacement::relax_on_stars(int sweeps, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  const std::size_t points = mesh.points.size();
  std::vector<NodeFreedom> freedom(points + mesh.edges.size());
  for (const auto& [point, value] : fixed_points_) freedom[point].held = true;
  for (const BoundaryPart& part : mesh.boundary) {
    const bool rolls = condition_on<Roller>(discrete_.problem, part.name);
    for (const int edge : part.edges) {
      if (condition_on<Fixed>(discrete_.problem, part.name)) freedom[points + edge].held = true;
      if (!rolls) continue;
      const Vector n = mesh.outward_normal(edge);
      for (const std::size_t node :
           {std::size_t(mesh.edges[edge][0]), std::size_t(mesh.edges[edge][1]), points + edge})
        freedom[node].hold_along(n, mesh.rounding_of_normal(edge));
    }
  }
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    const double rounding = mesh.rounding_of_normal(contact.edge);
    for (const int point : mesh.edges[contact.edge]) freedom[point].hold_along(contact.direction, rounding);
    freedom[points + contact.edge].hold_along(contact.direction, rounding);
  }
  relax_displacement(discrete_, freedom, sweeps, points_, middles_, progress);
  if (beside_.base) return;
  CellBudget budget{kCellsOfGaps, &progress};
  for (const ContactEdge& contact : discrete_.clearance.edges)
    if (!follows_gap(contact)) lower_below(contact, budget);
}

std::optional<double> AdmissibleDisplacement::off_followed_gap(const ContactEdge& contact) const {
  const auto found = off_gap_.find(contact.edge);
  return found == off_gap_.end() ? std::nullopt : std::optional(found->second);
}

bool AdmissibleDisplacement::follows_gap(const ContactEdge& contact) const {
  return off_gap_.contains(contact.edge);
}

const Lift* AdmissibleDisplacement::lift(int edge) const {
  const auto found = lifts_.find(edge);
  return found == lifts_.end() ? nullptr : &found->second;
}

bool AdmissibleDisplacement::is_lifted(int t) const {
  return std::ranges::any_of(discrete_.mesh.triangle_edges[t],
                             [&](int edge) { return lift(edge) != nullptr; });
}

template <int D>
void AdmissibleDisplacement::add_lifts(int t, const Point& reference, const Eigen::Matrix2d& inverse_jacobian,
                                       Eigen::Matrix<double, D, 1>& value, Tensor<D>& slope) const {
  const Eigen::Vector3d hats(1 - reference.x() - reference.y(), reference.x(), reference.y());
  const Eigen::Matrix2d gradients = inverse_jacobian.transpose();
  const std::array<Vector, 3> hat_gradients{-gradients.rowwise().sum(), gradients.col(0), gradients.col(1)};
  for (int e = 0; e < 3; ++e) {
    const int edge = discrete_.mesh.triangle_edges[t][e];
    const Lift* lifted = lift(edge);
    if (!lifted) continue;
    int a = (e + 1) % 3, b = (e + 2) % 3;
    if (discrete_.mesh.triangles[t][a] != discrete_.mesh.edges[edge][0]) std::swap(a, b);
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
  const auto& [a, b] = discrete_.mesh.edges[edge];
  const Eigen::VectorXd quadratic = (1 - s) * (1 - 2 * s) * points_.col(a) +
                                    s * (2 * s - 1) * points_.col(b) + 4 * s * (1 - s) * middles_.col(edge);
  const Lift* lifted = lift(edge);
  return lifted ? Eigen::VectorXd(quadratic + (*lifted)(s)) : quadratic;
}

double AdmissibleDisplacement::along_contact(const ContactEdge& contact, double s) const {
  return direction(contact).dot(on_edge(contact.edge, s));
}

double AdmissibleDisplacement::room(const ContactEdge& contact, double s) const {
  return gap_at(contact, s) - along_contact(contact, s);
}

AdmissibleDisplacement::LiftRest AdmissibleDisplacement::rest_of_lifts(int t) const {
  LiftRest sum;
  for (const int edge : discrete_.mesh.triangle_edges[t]) {
    const auto found = rests_.find(edge);
    if (found == rests_.end()) continue;
    sum.value += found->second.value;
    sum.slope += found->second.slope;
  }
  return sum;
}

double AdmissibleDisplacement::largest_on(int t) const {
  return components_ == 1 ? bound_of_quadratic(on<1>(t)) : bound_of_quadratic(on<2>(t));
}

Eigen::VectorXd AdmissibleDisplacement::direction(const ContactEdge& contact) const {
  if (components_ == 1) return Eigen::VectorXd::Constant(1, -1);
  return contact.direction;
}

const Field& AdmissibleDisplacement::gap(const ContactEdge& contact) const {
  return gap_on(discrete_, contact);
}

/// Where the gap jumps in a node, that of this edge.
double AdmissibleDisplacement::gap_at(const ContactEdge& contact, double s) const {
  const Field& own = gap(contact);
  const EdgeLine line(discrete_.mesh, contact.edge);
  const double value = line.value(own, s);
  if (s > 0 && s < 1) return value;
  return values_at_end(own, line, s, kSmall * std::max(std::abs(value), scale_)).lower();
}

void AdmissibleDisplacement::refuse(const std::string& reason) {
  if (std::ranges::find(unmet_, reason) == unmet_.end()) unmet_.push_back(reason);
}

void AdmissibleDisplacement::refuse_point(int point) {
  refuse("no displacement meets all conditions at " + to_string(discrete_.mesh.points[point]));
}

/// The points of Γ_D get u_D; those of rollers, and of Γ_C, the nearest value that their edges allow.
void AdmissibleDisplacement::constrain_points() {
  const Mesh& mesh = discrete_.mesh;
  for (const BoundaryPart& part : mesh.boundary)
    if (const auto* fixed = condition_on<Fixed>(discrete_.problem, part.name))
      for (const int edge : part.edges) fix_points(edge, *fixed);

  for (const BoundaryPart& part : mesh.boundary)
    if (const auto* roller = condition_on<Roller>(discrete_.problem, part.name))
      for (const int edge : part.edges)
        for (const int point : mesh.edges[edge]) {
          const Vector n = mesh.outward_normal(edge);
          constrain(point, {n, roller->motion(mesh.points[point]).dot(n), true, true,
                            mesh.rounding_of_normal(edge)});
        }
}

/// The normals of a straight line are one, but for rounding, and must not meet in a point.
void AdmissibleDisplacement::constrain(int point, PointConstraint constraint) {
  for (const PointConstraint& known : constraints_[point])
    if (components_ == 2 &&
        is_same_direction(known.direction, constraint.direction, known.rounding + constraint.rounding))
      constraint.direction = known.direction;
  constraints_[point].push_back(std::move(constraint));
}

void AdmissibleDisplacement::constrain_to_gap() {
  for (const ContactEdge& contact : discrete_.clearance.edges)
    for (int k = 0; k < 2; ++k) {
      const double g = gap_at(contact, k);
      // A gap that is out of reach rounds nothing that matters.
      if (std::abs(g) < kReach * scale_) scale_ = std::max(scale_, std::abs(g));
      const bool touches = clearance_[contact.rows[k]] <= 0;
      constrain(discrete_.mesh.edges[contact.edge][k],
                {direction(contact), g, touches, false, discrete_.mesh.rounding_of_normal(contact.edge)});
    }
}

void AdmissibleDisplacement::admit_points() {
  for (const auto& [point, own] : constraints_) admit(point, own);
}

void AdmissibleDisplacement::meet_supports() {
  for (const BoundaryPart& part : discrete_.mesh.boundary) {
    if (const auto* fixed = condition_on<Fixed>(discrete_.problem, part.name)) fix(part, *fixed);
    if (const auto* roller = condition_on<Roller>(discrete_.problem, part.name)) roll(part, roller->motion);
  }
}

/// A quadratic v_n that has the mean of the trace and is further from g at the ends exceeds it in between. To
/// lower it there would change the volume, which costs the more the less compressible the body is: the ends
/// come as near to g as the trace instead, where the other conditions let them.
void AdmissibleDisplacement::follow_traces() {
  const Mesh& mesh = discrete_.mesh;
  auto constraints = constraints_;
  std::vector<bool> follows(discrete_.clearance.edges.size(), false);
  for (bool again = true; std::exchange(again, false);)
    for (std::size_t i = 0; i < follows.size(); ++i) {
      const ContactEdge& contact = discrete_.clearance.edges[i];
      if (follows[i] || !exceeds_gap(contact)) continue;
      follows[i] = again = true;
      for (int k = 0; k < 2; ++k) {
        const int point = mesh.edges[contact.edge][k];
        auto& own = constraints[point];
        if (fixed_points_.contains(point) ||
            turns_slightly(own, discrete_.problem.material, mesh.points[point]))
          continue;
        own.push_back({-direction(contact), clearance_[contact.rows[k]] - gap_at(contact, k), false});
        if (const auto nearest = nearest_admissible(points_.col(point), own, scale_))
          points_.col(point) = *nearest;
      }
    }
}

/// The quadratic function that has the values r₀ ≥ 0 and r₁ ≥ 0 at the ends and the mean m is negative
/// somewhere if 3 (r₀ + r₁) − 6 m > (√r₀ + √r₁)².
bool AdmissibleDisplacement::exceeds_gap(const ContactEdge& contact) const {
  std::array<double, 2> room;
  for (int k = 0; k < 2; ++k) {
    const int point = discrete_.mesh.edges[contact.edge][k];
    room[k] = std::max(0., gap_at(contact, k) - direction(contact).dot(points_.col(point)));
  }
  const double mean = (clearance_[contact.rows[0]] + clearance_[contact.rows[1]]) / 2;
  const double root = std::sqrt(room[0]) + std::sqrt(room[1]);
  return 3 * (room[0] + room[1]) - 6 * mean > root * root + kSmall * scale_;
}

void AdmissibleDisplacement::fix_points(int edge, const Fixed& fixed) {
  for (int end = 0; end < 2; ++end) {
    const int point = discrete_.mesh.edges[edge][end];
    const auto [x, normal] = discrete_.mesh.on_boundary(edge, end);
    const Eigen::VectorXd value = value_of(fixed.value, components_, x, normal);
    scale_ = std::max(scale_, value.lpNorm<Eigen::Infinity>());
    const auto [known, is_new] = fixed_points_.try_emplace(point, value);
    points_.col(point) = known->second;
    if (!is_new && (known->second - value).lpNorm<Eigen::Infinity>() > kSmall * scale_)
      refuse("the fixed values jump at " + to_string(discrete_.mesh.points[point]));
  }
}

void AdmissibleDisplacement::admit(int point, std::vector<PointConstraint> constraints) {
  const Eigen::VectorXd v = points_.col(point);
  std::optional<Eigen::VectorXd> nearest;
  const bool is_fixed = fixed_points_.contains(point);
  if (!is_fixed && !turns_slightly(constraints, discrete_.problem.material, discrete_.mesh.points[point]))
    nearest = nearest_admissible(v, constraints, scale_);
  if (!nearest) {
    for (PointConstraint& constraint : constraints) constraint.equality = constraint.is_roller;
    nearest = nearest_admissible(v, constraints, scale_);
  }
  if (!nearest || (is_fixed && (*nearest - v).norm() > kNearly * scale_))
    refuse_point(point);
  else if (!is_fixed)
    points_.col(point) = *nearest;
}

/// The mean of v_h over each edge is that of m.
void AdmissibleDisplacement::set_middles(const Eigen::VectorXd& coupling) {
  const Mesh& mesh = discrete_.mesh;
  const int per_edge = discrete_.spaces().traces_per_edge(), functions = per_edge / components_;
  middles_.resize(components_, mesh.edges.size());
  for (int t = 0; t < discrete_.triangles(); ++t) {
    const LocalVector traces = discrete_.traces.values(t, coupling);
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
    const EdgeLine line(discrete_.mesh, edge);
    const auto value = [&](double s) {
      const auto [x, normal] = discrete_.mesh.on_boundary(edge, s);
      return value_of(fixed.value, components_, x, normal);
    };
    middles_.col(edge) = value(0.5);
    add_lift(edge, [&](double s) -> Eigen::VectorXd { return value(s) - on_edge(edge, s); });
    for (const Field& field : fixed.value.fields()) {
      for (const double s : {0., 1.})
        if (jumps_at_end(field, line, s, kSmall * scale_))
          refuse(field.name() + " jumps at " + to_string(line.at(s)));
      add_rest(edge, line, field);
    }
  }
}

/// Of the order of the lifts: below this what they are off by does not count.
double AdmissibleDisplacement::small_coefficient() const {
  return 1e-9 * scale_ / Lift::errors().slope;
}

/// The rest d of a value is lifted by ρ d(λ_b / ρ), ρ = λ_a + λ_b, with |∇| ≤ (|d| + |d'|) |∇ρ| + |d'|
/// |∇λ_b|.
void AdmissibleDisplacement::add_rest(int edge, const EdgeLine& line, const Field& field) {
  if (field.is_constant() || field.is_quadratic_on_edges()) return;
  if (!field.formula()) return refuse(field.name() + " is a function that is known in single points only");
  const double ninth = largest_coefficient(field, line, Lift::kDegree + 1, small_coefficient());
  if (!std::isfinite(ninth))
    return refuse(field.name() + " is not smooth along the boundary near " + to_string(line.at(0.5)) +
                  ": put a point of the mesh where it has its kink, or make it smooth");
  if (ninth == 0) return;
  const Lift::Errors& errors = Lift::errors();
  const double d = ninth * errors.value, slope = ninth * errors.slope;
  const int t = discrete_.mesh.edge_triangles[edge][0], e = discrete_.mesh.local_edge(t, edge);
  const Eigen::Matrix2d gradients = AffineMap(discrete_.mesh.corners(t)).jacobian.inverse().transpose();
  const std::array<Vector, 3> hats{-gradients.rowwise().sum(), gradients.col(0), gradients.col(1)};
  const double of_b = std::max(hats[(e + 1) % 3].norm(), hats[(e + 2) % 3].norm());
  LiftRest& rest = rests_[edge];
  rest.value += d;
  rest.slope += (d + slope) * hats[e].norm() + slope * of_b;
}

void AdmissibleDisplacement::roll(const BoundaryPart& part, const SupportMotion& motion) {
  const Mesh& mesh = discrete_.mesh;
  for (const int edge : part.edges) {
    const Eigen::VectorXd n = mesh.outward_normal(edge);
    const auto& [a, b] = mesh.edges[edge];
    const Vector moved = motion((mesh.points[a] + mesh.points[b]) / 2);
    middles_.col(edge) -= n.dot(middles_.col(edge) - moved) * n;
  }
}

void AdmissibleDisplacement::meet(const ContactEdge& contact, CellBudget& budget) {
  if (!is_known_on_edges(gap(contact)))
    refuse(gap(contact).name() + " is a function that is known in single points only: give a formula");
  const auto& [a, b] = discrete_.mesh.edges[contact.edge];
  for (const int k : {0, 1})
    if (room(contact, k) < -kNearly * scale_) return refuse_point(k == 0 ? a : b);
  const Eigen::VectorXd n = direction(contact);
  const auto touches_in = [&](int point, int k) {
    return std::abs(n.dot(points_.col(point)) - gap_at(contact, k)) <= kSmall * scale_;
  };
  if (follows_gap(contact) && touches_in(a, 0) && touches_in(b, 1))
    close(contact);
  else
    lower_below(contact, budget);
}

/// Where a polynomial is off by more than the gap differs from a straight line, as where it has many waves on
/// an edge, to stay below the gap is better than to follow it.
void AdmissibleDisplacement::find_followed_gaps() {
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    if (clearance_[contact.rows[0]] > 0 || clearance_[contact.rows[1]] > 0) continue;
    const Field& own = gap(contact);
    const EdgeLine line(discrete_.mesh, contact.edge);
    const double ninth =
        own.formula() ? largest_coefficient(own, line, Lift::kDegree + 1, small_coefficient()) : 0;
    const double off = ninth * Lift::errors().over_bubble;
    if (off <= kNearly * scale_ || off <= bend(own, line)) off_gap_.emplace(contact.edge, off);
  }
}

/// v_n = g, but for what the polynomial is off by, as a multiple of the bubble 4 s (1 − s).
void AdmissibleDisplacement::close(const ContactEdge& contact) {
  const int edge = contact.edge;
  const Eigen::VectorXd n = direction(contact);
  middles_.col(edge) += room(contact, 0.5) * n;
  add_lift(edge, [&](double s) -> Eigen::VectorXd { return room(contact, s) * n; });
  middles_.col(edge) -= off_gap_.at(edge) * n;
}

BelowGap AdmissibleDisplacement::below_gap(const ContactEdge& contact, const EdgeLine& line) const {
  return {gap(contact),
          line,
          {along_contact(contact, 0), along_contact(contact, 0.5), along_contact(contact, 1)},
          {room(contact, 0), room(contact, 1)}};
}

/// Where bubbles alone would be high, BelowGap::level(): v changes by what is linear on the triangles around
/// a point, which keeps what is below the gap there.
void AdmissibleDisplacement::lower_points(CellBudget& budget) {
  const Mesh& mesh = discrete_.mesh;
  std::map<int, std::vector<PointConstraint>> lower;
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    if (follows_gap(contact) || !is_known_on_edges(gap(contact))) continue;
    const EdgeLine line(mesh, contact.edge);
    double level = 0;
    budget.share(kShares, [&](CellBudget& own) { level = below_gap(contact, line).level(own); });
    if (level == 0) continue;
    for (const int k : {0, 1}) {
      const int point = mesh.edges[contact.edge][k];
      if (!fixed_points_.contains(point))
        lower[point].push_back({direction(contact), along_contact(contact, k) - level, false});
    }
  }
  if (lower.empty()) return;
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(components_, points_.cols());
  for (auto& [point, own] : lower) {
    for (PointConstraint known : constraints_[point]) {
      known.equality = known.is_roller;
      own.push_back(std::move(known));
    }
    if (const auto nearest = nearest_admissible(points_.col(point), own, scale_))
      change.col(point) = *nearest - points_.col(point);
  }
  points_ += change;
  for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
    middles_.col(edge) += (change.col(mesh.edges[edge][0]) + change.col(mesh.edges[edge][1])) / 2;
}

/// v_n ≤ g by a multiple of the bubble 4 s (1 − s).
void AdmissibleDisplacement::lower_below(const ContactEdge& contact, CellBudget& budget) {
  const EdgeLine line(discrete_.mesh, contact.edge);
  double needed = 0;
  budget.share(kShares, [&](CellBudget& own) { needed = below_gap(contact, line).bubble(own); });
  if (!std::isfinite(needed))
    refuse(is_known(series_on(gap(contact), line, Interval(0, 1), 0)[0])
               ? gap(contact).name() + " falls from what is fixed beside " + to_string(line.at(0.5)) +
                     " without bound on its slope: raise it there, or lower what is fixed"
               : not_known_to_be_finite(gap(contact), line.at(0.5)));
  else if (needed > 0)
    middles_.col(contact.edge) -= needed * direction(contact);
}

void AdmissibleDisplacement::add_lift(int edge, const Values& d) {
  Lift lift(components_, d);
  if (lift.largest() > kSmall * scale_) lifts_.emplace(edge, std::move(lift));
}

}  // namespace signorini
