#include "fem/projection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "fem/triangle_pieces.hpp"

namespace signorini {
namespace {

/// What the integrals of a function that jumps along a curve, on a few triangles, may be off by, in
/// tolerances.
constexpr double kToleranceOfJumps = 500;

using Nodes = Projection::Nodes;

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

/// f on a triangle in the points of the rules of all its pieces, with what the sums are off by. Integrals are
/// over the reference triangle.
struct Samples {
  std::vector<Point> points;
  std::vector<double> weights, values;
  double force = 0, work = 0;  ///< ProjectedLoad::uncertain_force, uncertain_work
  double value_square =
      0;  ///< of what f is off by from polynomials of which the rule knows the square, ∫ ( )²
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
  Sampler(const Field& field, const std::array<Point, 3>& corners, double tolerance, CellBudget& budget)
      : field_(field), map_(corners), tolerance_(tolerance) {
    const Field* fields[] = {&field};
    const Settled settled = [&](const Corners& cell, double share) { return add_smooth(cell, share); };
    const Acceptance of_smooth = mean_remainder_below(tolerance),
                     of_jump = mean_remainder_below(kToleranceOfJumps * tolerance);
    const Acceptance accept = [&](const std::vector<TaylorModel>& models, double share, double of_cell) {
      return (is_undecided_ ? of_jump : of_smooth)(models, share, of_cell);
    };
    for_each_piece(
        fields, corners, accept, budget, [&](const TrianglePiece& piece) { add_piece(piece); }, settled);
  }

  const Samples& samples() const { return samples_; }

 private:
  using Corners = std::array<Point, 3>;

  bool add_smooth(const Corners& cell, double share) {
    const Series series = series_on_triangle(*field_.formula(), {map_(cell[0]), map_(cell[1]), map_(cell[2])},
                                             Series::kMost, is_undecided_);
    const auto r = [&](int k) { return largest(series[k]); };
    const double allowed = tolerance_ / std::sqrt(share);
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
  const double tolerance_;
  bool is_undecided_ = false;  ///< a jump or a kink may lie in the last cell that was looked at
  Samples samples_;
};

/// The value of a function that has one on the whole triangle, as beside a jump: most loads do not vary else.
std::optional<double> only_value(const Field& field, const std::array<Point, 3>& corners) {
  if (field.is_constant()) return field(corners[0]);
  if (!field.formula()) return std::nullopt;
  bool undecided = false;
  const Interval values = range(series_on_triangle(*field.formula(), corners, 0, undecided));
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

Projection project(const Field& field, const std::array<Point, 3>& corners, double tolerance,
                   CellBudget& budget) {
  Projection own;
  if (const auto value = only_value(field, corners)) {
    own.quadratic.setConstant(*value);
    own.linear = own.quadratic;
    return own;
  }
  const Samples samples = field.formula() ? Sampler(field, corners, tolerance, budget).samples()
                                          : sampled(field, AffineMap(corners));
  own.quadratic = samples.projection();
  own.linear = own.quadratic * onto_linear();
  own.rest = samples.rest(own.quadratic);
  const Nodes between = own.quadratic - own.linear;
  own.between = norm(between);
  // What is uncertain of (f − Π₂f, Π₂f − Π₁f); the functions of P2 add up to at most 5/3 in absolute value.
  const double uncertain = 2 * samples.work * between.cwiseAbs().maxCoeff() * 5 / 3;
  own.beyond_linear = std::sqrt(own.rest * own.rest + own.between * own.between + uncertain);
  own.uncertain_force = samples.force;
  own.uncertain_work = samples.work;
  own.jumps = samples.jumps;
  own.is_finite = samples.is_finite;
  return own;
}

Projection::Nodes linear_part(const Projection::Nodes& quadratic) {
  return quadratic * onto_linear();
}

double norm(const Projection::Nodes& quadratic) {
  return std::sqrt(quadratic * mass() * quadratic.transpose());
}

}  // namespace signorini
