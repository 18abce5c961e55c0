#include "fem/load_projection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "fem/triangle_pieces.hpp"

namespace signorini {
namespace {

/// What an integral may be off by, relative to the largest load: what is uncertain is carried to the fixed parts by
/// an estimate that is some thousand times too large.
constexpr double kTolerance = 1e-9;
/// The same where f jumps along a curve, on a few triangles.
constexpr double kToleranceOfJumps = 5e-7;

/// Of what f has between P1 and P2: if the rest is larger where f jumps, that part is left with it.
constexpr double kMuch = 0.2;

using Nodes = Eigen::Matrix<double, 1, 6>;

/// ∫ φ_i φ_j over the reference triangle for the basis of P2.
const Eigen::Matrix<double, 6, 6>& mass() {
  static const Eigen::Matrix<double, 6, 6> all = [] {
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    for (const auto& [point, weight] : rule_of_degree(5))
      sum += weight * quadratic_basis(point) * quadratic_basis(point).transpose();
    return sum;
  }();
  return all;
}

const Eigen::Matrix<double, 6, 6>& inverse_mass() {
  static const Eigen::Matrix<double, 6, 6> inverse = mass().inverse();
  return inverse;
}

/// The projection onto P1 of what is quadratic, both at the nodes of P2.
const Eigen::Matrix<double, 6, 6>& onto_linear() {
  static const Eigen::Matrix<double, 6, 6> map = []() -> Eigen::Matrix<double, 6, 6> {
    // The linear functions at the nodes, from their values at the corners.
    Eigen::Matrix<double, 3, 6> linear = Eigen::Matrix<double, 3, 6>::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      linear(corner, corner) = 1;
      for (const int other : {1, 2}) linear(corner, 3 + (corner + other) % 3) = 0.5;
    }
    const Eigen::Matrix3d of_linear = linear * mass() * linear.transpose();
    return mass() * linear.transpose() * of_linear.inverse() * linear;
  }();
  return map;
}

/// f on a triangle in the points of the rules of all its pieces, with what the sums are off by. Integrals are over the
/// reference triangle.
struct Samples {
  std::vector<Point> points;
  std::vector<double> weights, values;
  double force = 0, work = 0;   ///< ProjectedLoad::uncertain_force, uncertain_work
  double value_square = 0;      ///< of what f is off by from polynomials of which the rule knows the square, ∫ ( )²
  bool is_finite = true;
  bool jumps = false;  ///< or has a kink

  Nodes projection() const {
    Nodes moments = Nodes::Zero();
    for (std::size_t q = 0; q < points.size(); ++q)
      moments += weights[q] * values[q] * quadratic_basis(points[q]).transpose();
    return moments * inverse_mass();
  }

  double rest(const Nodes& projection) const {
    double square = 0;
    for (std::size_t q = 0; q < points.size(); ++q) {
      const double own = values[q] - projection * quadratic_basis(points[q]);
      square += weights[q] * own * own;
    }
    return std::sqrt(square) + std::sqrt(value_square);
  }
};

class Sampler {
 public:
  Sampler(const Field& field, const std::array<Point, 3>& corners, double largest, CellBudget& budget)
      : field_(field), map_(corners), largest_(largest) {
    const Field* fields[] = {&field};
    const Settled settled = [&](const Corners& cell, double share) { return add_smooth(cell, share); };
    const Acceptance of_smooth = mean_remainder_below(kTolerance * largest),
                     of_jump = mean_remainder_below(kToleranceOfJumps * largest);
    const Acceptance accept = [&](const std::vector<TaylorModel>& models, double share, double of_cell) {
      return (is_undecided_ ? of_jump : of_smooth)(models, share, of_cell);
    };
    for_each_piece(fields, corners, accept, budget, [&](const TrianglePiece& piece) { add_piece(piece); }, settled);
  }

  const Samples& samples() const { return samples_; }

 private:
  using Corners = std::array<Point, 3>;

  bool add_smooth(const Corners& cell, double share) {
    const Series series =
        series_on_triangle(*field_.formula(), {map_(cell[0]), map_(cell[1]), map_(cell[2])}, Series::kMost,
                           is_undecided_);
    const auto r = [&](int k) { return largest(series[k]); };
    const double allowed = kTolerance * largest_ / std::sqrt(share);
    for (const int degree : {8, 10}) {
      if (!(2 * r(degree) <= allowed)) continue;
      add(cell, share, degree);
      samples_.force += share * r(degree);
      samples_.work += share * r(degree - 1);
      samples_.value_square += share / 2 * 4 * r(degree / 2 + 1) * r(degree / 2 + 1);
      return true;
    }
    samples_.jumps = samples_.jumps || is_undecided_;
    return false;
  }

  void add_piece(const TrianglePiece& piece) {
    const double remainder = piece.models[0].remainder();
    samples_.is_finite = samples_.is_finite && std::isfinite(remainder);
    if (!samples_.is_finite) return;
    for (const auto& [point, weight] : rule_of_degree(8)) {
      samples_.points.push_back(piece(point));
      samples_.weights.push_back(piece.share * weight);
      samples_.values.push_back(piece.models[0].at(point.x(), point.y()));
    }
    samples_.force += piece.share / 2 * remainder;
    samples_.work += piece.share / 2 * remainder;
    samples_.value_square += piece.share / 2 * remainder * remainder;
  }

  void add(const Corners& cell, double share, int degree) {
    for (const auto& [point, weight] : rule_of_degree(degree)) {
      const Point own = cell[0] + point.x() * (cell[1] - cell[0]) + point.y() * (cell[2] - cell[0]);
      samples_.points.push_back(own);
      samples_.weights.push_back(share * weight);
      samples_.values.push_back(field_(map_(own)));
    }
  }

  const Field& field_;
  const AffineMap map_;
  const double largest_;
  bool is_undecided_ = false;  ///< a jump or a kink may lie in the last cell that was looked at
  Samples samples_;
};

/// The value of a formula that has one on the whole triangle, as beside a jump: most loads do not vary else.
std::optional<double> only_value(const Formula& formula, const std::array<Point, 3>& corners) {
  bool undecided = false;
  const Interval values = range(series_on_triangle(formula, corners, 0, undecided));
  if (undecided || values.lower() != values.upper()) return std::nullopt;
  return values.lower();
}

Samples sampled(const Field& function, const AffineMap& map) {
  Samples samples;
  for (const auto& [point, weight] : rule_of_degree(8)) {
    samples.points.push_back(point);
    samples.weights.push_back(weight);
    samples.values.push_back(function(map(point)));
  }
  return samples;
}

}  // namespace

LoadProjection::LoadProjection(const Problem& problem, const Mesh& mesh, Progress* progress) {
  const VectorField& body = problem.body;
  const int count = static_cast<int>(mesh.triangles.size()), d = components(problem.material);
  ProjectedLoad constant{Eigen::MatrixXd::Zero(d, 6), Eigen::MatrixXd::Zero(d, 6)};
  for (int c = 0; c < body.size(); ++c)
    if (body.fields()[c].is_constant()) constant.projection.row(c).setConstant(body(c, Point::Zero()));
  constant.balanced = constant.projection;
  if (std::ranges::all_of(body.fields(), &Field::is_constant)) {
    all_.push_back(constant);
    return;
  }
  double largest = 0;
  for (int t = 0; t < count; ++t)
    for (int c = 0; c < body.size(); ++c) largest = std::max(largest, std::abs(body(c, mesh.centroid(t))));
  CellBudget budget{20 * count + 100'000};
  all_.assign(count, constant);
  for (int t = 0; t < count; ++t) {
    if (progress && t % 64 == 0) progress->check();
    const AffineMap map(mesh.corners(t));
    double rest_square = 0, unbalanced_square = 0;
    for (int c = 0; c < d; ++c) {
      const Field& field = body.fields()[c];
      if (field.is_constant()) continue;
      if (const auto value = field.formula() ? only_value(*field.formula(), mesh.corners(t)) : std::nullopt) {
        all_[t].projection.row(c).setConstant(*value);
        all_[t].balanced.row(c).setConstant(*value);
        continue;
      }
      const Samples samples =
          field.formula() ? Sampler(field, mesh.corners(t), largest, budget).samples() : sampled(field, map);
      if (!field.formula() && unmet_.empty())
        unmet_.push_back(field.name() + " is a function that is known in single points only: give a formula");
      if (!samples.is_finite && unmet_.empty())
        unmet_.push_back(field.name() + " is not known to be finite near " + to_string(mesh.centroid(t)));
      const Nodes projection = samples.projection();
      const double rest = samples.rest(projection);
      const Nodes linear = projection * onto_linear(), between = projection - linear;
      const double of_between = between * mass() * between.transpose();
      const bool leaves = samples.jumps && rest > kMuch * std::sqrt(of_between);
      all_[t].projection.row(c) = projection;
      all_[t].balanced.row(c) = leaves ? linear : projection;
      all_[t].uncertain_force += map.determinant * samples.force;
      all_[t].uncertain_work += map.determinant * samples.work;
      // Below this the rest is rounding.
      if (rest <= kEnclosureRounding * largest) continue;
      rest_square += map.determinant * rest * rest;
      // What is uncertain of (f − Π₂f, Π₂f − Π₁f); the functions of P2 add up to at most 5/3 in absolute value.
      const double uncertain = 2 * samples.work * between.cwiseAbs().maxCoeff() * 5 / 3;
      unbalanced_square += map.determinant * (rest * rest + (leaves ? of_between + uncertain : 0));
    }
    all_[t].rest = std::sqrt(rest_square);
    all_[t].unbalanced = std::sqrt(unbalanced_square);
  }
}

}  // namespace signorini
