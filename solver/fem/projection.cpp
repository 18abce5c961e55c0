#include "fem/projection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "fem/triangle_pieces.hpp"
#include "formula/interval.hpp"
#include "formula/rounding.hpp"

namespace signorini {
namespace {

using Nodes = Projection::Nodes;

const Eigen::Matrix<double, 6, 6>& inverse_mass() {
  static const Eigen::Matrix<double, 6, 6> inverse = quadratic_mass().inverse();
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
    const Eigen::Matrix3d of_linear = linear * quadratic_mass() * linear.transpose();
    return quadratic_mass() * linear.transpose() * of_linear.inverse() * linear;
  }();
  return map;
}

/// f on a triangle in the points of the rules of all its pieces, with what the sums are off by. Integrals are
/// over the reference triangle.
class Samples {
 public:
  double force = 0, work = 0;  ///< ProjectedLoad::uncertain_force, uncertain_work
  double value_square =
      0;  ///< of what f is off by from polynomials of which the rule knows the square, ∫ ( )²
  bool is_finite = true;
  bool jumps = false;  ///< or has a kink

  void add(const Point& point, double weight, double value) {
    points_.push_back(point);
    weights_.push_back(weight);
    values_.push_back(value);
    if (points_.size() == kKept) sum_up();
  }

  Nodes projection() const {
    return Nodes::Constant(mean_) + (moments_ + moments_of_kept()) * inverse_mass();
  }

  double rest(const Nodes& projection) const {
    double square = 0;
    if (!is_summed_up_) {
      for (std::size_t q = 0; q < points_.size(); ++q) {
        const double own = values_[q] - projection * quadratic_basis(points_[q]);
        square += weights_[q] * own * own;
      }
    } else {
      const Nodes beyond_mean = projection - Nodes::Constant(mean_);
      const double whole = square_ + square_of_kept();
      square = std::max(0., whole - beyond_mean * quadratic_mass() * beyond_mean.transpose()) +
               kEnclosureRounding * whole;
    }
    return std::sqrt(square) + std::sqrt(value_square);
  }

 private:
  /// A function of more points has many cells, each with a few: then only the sums are kept, of what it has
  /// beyond its mean. To a function that is nearly a polynomial of P2, of which the difference of sums would
  /// know little, that does not happen.
  static constexpr std::size_t kKept = 10'000;

  Nodes moments_of_kept() const {
    Nodes moments = Nodes::Zero();
    for (std::size_t q = 0; q < points_.size(); ++q)
      moments += weights_[q] * (values_[q] - mean_) * quadratic_basis(points_[q]).transpose();
    return moments;
  }

  double square_of_kept() const {
    double square = 0;
    for (std::size_t q = 0; q < points_.size(); ++q)
      square += weights_[q] * (values_[q] - mean_) * (values_[q] - mean_);
    return square;
  }

  void sum_up() {
    if (!is_summed_up_) {
      double area = 0, sum = 0;
      for (std::size_t q = 0; q < points_.size(); ++q) {
        area += weights_[q];
        sum += weights_[q] * values_[q];
      }
      mean_ = sum / area;
      is_summed_up_ = true;
    }
    moments_ += moments_of_kept();
    square_ += square_of_kept();
    points_.clear();
    weights_.clear();
    values_.clear();
  }

  std::vector<Point> points_;
  std::vector<double> weights_, values_;
  bool is_summed_up_ = false;
  double mean_ = 0;                ///< once summed up
  Nodes moments_ = Nodes::Zero();  ///< of the points that are no more kept, ∫ (f − mean) φ
  double square_ = 0;              ///< ∫ (f − mean)²
};

class Sampler {
 public:
  Sampler(const Field& field, const std::array<Point, 3>& corners, const ProjectionTolerance& tolerance,
          CellBudget& budget)
      : field_(field),
        map_(corners),
        tolerances_(tolerance),
        budget_(budget),
        patient_until_(budget.cells - kFew) {
    const Field* fields[] = {&field};
    for_each_piece(
        fields, corners,
        [&](const Models& models, double share, double of_cell) {
          return models[0].remainder() * share <= tolerance_now() * std::sqrt(of_cell);
        },
        budget, [&](const TrianglePiece& piece) { add_piece(piece); },
        [&](const Corners& cell, double share) { return add_smooth(cell, share); });
  }

  /// Of a function that has no bound somewhere nothing is known but its values.
  const Samples& samples() const { return values_.is_finite ? samples_ : values_; }

 private:
  using Corners = std::array<Point, 3>;

  /// By so many cells a function that is smooth meets the fine tolerance, unless the triangle is large beside
  /// its waves.
  static constexpr int kFew = 64;

  double tolerance_now() const {
    return budget_.cells > patient_until_ ? tolerances_.fine : tolerances_.rough;
  }

  bool add_smooth(const Corners& cell, double share) {
    const Corners place{map_(cell[0]), map_(cell[1]), map_(cell[2])};
    const Formula& formula = *field_.formula();
    // Most cells lie on curves: there its derivatives are not known, nor worth their work.
    bool is_undecided = false;
    const Interval values = range(series_on_triangle(formula, place, 0, is_undecided, true));
    samples_.jumps = values_.jumps = samples_.jumps || is_undecided;
    if (is_undecided || !is_known(values)) return false;
    const Series series = series_on_triangle(formula, place, Series::kMost, is_undecided);
    const auto r = [&](int k) { return largest(series[k]); };
    const double allowed = tolerance_now() / std::sqrt(share);
    for (const int degree : {5, 8, 10}) {
      if (degree == 5 ? r(3) > 0 : !(2 * r(degree) <= allowed)) continue;
      add(cell, share, degree);
      samples_.force += share * r(degree);
      samples_.work += share * r(degree - 1);
      samples_.value_square += share / 2 * 4 * r(degree / 2 + 1) * r(degree / 2 + 1);
      return true;
    }
    return false;
  }

  /// By its model m, which f is off from by at most the remainder ρ. Where that is so large that m tells
  /// little of f, as beside a quotient of what vanishes, f counts by its values in the points, which are
  /// within ρ of m: then the sums are off by at most 2 ρ.
  void add_piece(const TrianglePiece& piece) {
    const TaylorModel& model = piece.models[0];
    const auto& rule = rule_of_degree(8);
    std::vector<double> values;
    double largest = 0;
    for (const auto& [point, weight] : rule) {
      const double value = field_(map_(piece(point)));
      values.push_back(std::isfinite(value) ? value : 0);
      largest = std::max(largest, std::abs(values.back()));
      values_.add(piece(point), piece.share * weight, values.back());
    }
    values_.is_finite = values_.is_finite && std::isfinite(model.remainder());
    if (!values_.is_finite) return;
    constexpr double little_known = 4;
    const bool by_values = model.remainder() > little_known * largest;
    for (std::size_t q = 0; q < rule.size(); ++q) {
      const auto& [point, weight] = rule[q];
      const double value = by_values ? values[q] : model.at(point.x(), point.y());
      samples_.add(piece(point), piece.share * weight, value);
    }
    const double off = (by_values ? 2 : 1) * model.remainder();
    samples_.force += piece.share / 2 * off;
    samples_.work += piece.share / 2 * off;
    samples_.value_square += piece.share / 2 * off * off;
  }

  void add(const Corners& cell, double share, int degree) {
    for (const auto& [point, weight] : rule_of_degree(degree)) {
      const Point own = cell[0] + point.x() * (cell[1] - cell[0]) + point.y() * (cell[2] - cell[0]);
      const double value = field_(map_(own));
      samples_.add(own, share * weight, value);
      values_.add(own, share * weight, value);
    }
  }

  const Field& field_;
  const AffineMap map_;
  const ProjectionTolerance tolerances_;
  const CellBudget& budget_;
  const int patient_until_;  ///< while the budget has more than so many cells the tolerance is the fine one
  Samples samples_;
  Samples values_;  ///< of the values of f alone, which say nothing of what lies between the points
};

/// The value of a function that has one on the whole triangle, as beside a jump: most loads do not vary else.
std::optional<double> only_value(const Field& field, const std::array<Point, 3>& corners) {
  if (field.is_constant()) return field(corners[0]);
  if (!field.formula()) return std::nullopt;
  bool undecided = false;
  const Interval values = range(series_on_triangle(*field.formula(), corners, 0, undecided, true));
  if (undecided || values.lower() != values.upper()) return std::nullopt;
  return values.lower();
}

Samples sampled(const Field& function, const AffineMap& map) {
  Samples samples;
  for (const auto& [point, weight] : rule_of_degree(8)) samples.add(point, weight, function(map(point)));
  return samples;
}

/// What the values on the triangle are off by, which changes little from place to place but where it is
/// small.
double rounding_on(const Field& field, const std::array<Point, 3>& corners, double none) {
  if (!field.formula()) return 0;
  const auto at = [&](const Point& x) { return rounding_of(*field.formula(), x.x(), x.y()); };
  constexpr double little = 0.01;
  double most = at((corners[0] + corners[1] + corners[2]) / 3);
  if (most <= little * none) return 0;
  for (const Point& corner : corners)
    if (const double own = at(corner); std::isfinite(own)) most = std::max(most, own);
  return most > none ? most : 0;
}

/// The values are not those of f, but those of a function that differs from it by so much.
void add_rounding(double rounding, Projection& projection) {
  projection.rest += rounding * std::sqrt(0.5);
  projection.beyond_linear += rounding * std::sqrt(0.5);
  projection.uncertain_force += rounding / 2;
  projection.uncertain_work += rounding / 2;
}

/// As the values in doubles are.
Projection project_values(const Field& field, const std::array<Point, 3>& corners,
                          const ProjectionTolerance& tolerance, CellBudget& budget) {
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

}  // namespace

Projection project(const Field& field, const std::array<Point, 3>& corners,
                   const ProjectionTolerance& tolerance, CellBudget& budget) {
  Projection own = project_values(field, corners, tolerance, budget);
  add_rounding(rounding_on(field, corners, tolerance.rounding), own);
  return own;
}

std::optional<double> constant_on(const Field& field, const Eigen::AlignedBox2d& box, double rounding) {
  const std::array<Point, 3> around = triangle_around(box);
  const std::optional<double> value = only_value(field, around);
  return value && rounding_on(field, around, rounding) == 0 ? value : std::nullopt;
}

Projection::Nodes linear_part(const Projection::Nodes& quadratic) {
  return quadratic * onto_linear();
}

double norm(const Projection::Nodes& quadratic) {
  return std::sqrt(quadratic * quadratic_mass() * quadratic.transpose());
}

}  // namespace signorini
