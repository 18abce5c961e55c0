// The values of v_h in the points of the boundary, and what is lifted from supports.

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/displacement/largest_coefficient.hpp"
#include "fem/edge_pieces.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

/// So many times the largest displacement is out of reach.
constexpr double kReach = 1e3;

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

}  // namespace

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

}  // namespace signorini
