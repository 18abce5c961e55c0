#include "fem/traction_field.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "fem/edge_pieces.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "formula/rounding.hpp"

namespace signorini {
namespace {

/// What an integral may be off by, relative to the largest traction: where it is smooth, and around a point
/// where it is not, which takes a cell for every half of it.
constexpr double kToleranceOfSmooth = 1e-9, kToleranceOfRough = 1e-8;

/// Of values, relative to the largest traction: less counts as none.
constexpr double kTractionRounding = 100 * kEnclosureRounding;

/// Of all edges together.
constexpr int kCells = 20'000;

/// A scalar on an edge times a fixed vector.
struct Part {
  const Field& field;
  Eigen::VectorXd vector;
};

std::vector<Part> parts_of(const Condition& condition, int components, const Vector& normal) {
  std::vector<Part> parts;
  const auto add = [&](const VectorField& value) {
    for (int c = 0; c < value.size(); ++c)
      parts.push_back({value.fields()[c], Eigen::VectorXd::Unit(components, c)});
  };
  if (const auto* pressure = std::get_if<Pressure>(&condition)) {
    parts.push_back({pressure->value, -normal});
    add(pressure->besides);
  }
  if (const auto* traction = std::get_if<Traction>(&condition)) add(traction->value);
  return parts;
}

/// A scalar on an edge in the points of Gauss on each of some pieces, with what the sums are off by.
class EdgeProjection {
 public:
  EdgeProjection(const Field& field, const EdgeLine& edge, double largest, CellBudget& budget)
      : field_(field), edge_(edge), largest_(largest) {
    if (field.formula())
      cut(budget);
    else
      add(Interval(0, 1));
    LocalVector moments = LocalVector::Zero(3);
    for (std::size_t q = 0; q < points_.size(); ++q)
      moments += weights_[q] * values_[q] * edge_basis(2, points_[q]);
    nodes = project_onto_edge(2, moments);
    if (field.formula()) add_rounding();
  }

  Eigen::Vector3d nodes;
  double force = 0, work = 0;
  bool is_finite = true;

  double rest() const {
    double square = 0;
    for (std::size_t q = 0; q < points_.size(); ++q) {
      const double own = values_[q] - nodes.dot(edge_basis(2, points_[q]));
      square += weights_[q] * own * own;
    }
    return std::sqrt(square) + std::sqrt(value_square_);
  }

 private:
  /// The rule is exact for degree 9.
  static constexpr int kOrder = 9;

  /// A part of the edge on which no more than the values are known.
  struct Cell {
    Interval s, values;

    double length() const { return s.upper() - s.lower(); }
    /// The middle of the values is off by no more.
    double radius() const { return (values.upper() - values.lower()) / 2; }
    bool operator<(const Cell& other) const {
      return std::pair(radius() * length(), length()) <
             std::pair(other.radius() * other.length(), other.length());
    }
  };

  /// The values are not those of the scalar, but those of one that differs from it by so much.
  void add_rounding() {
    double most = 0;
    for (const double s : {0., 0.5, 1.}) {
      const auto [x, n] = edge_.mesh.on_boundary(edge_.edge, s);
      const double own = rounding_of(*field_.formula(), x.x(), x.y(), n.x(), n.y());
      if (std::isfinite(own)) most = std::max(most, own);
    }
    if (most <= kTractionRounding * largest_) return;
    force += most;
    work += most;
    value_square_ += most * most;
  }

  void cut(CellBudget& budget) {
    look_at(Interval(0, 1));
    for (; !open_.empty() && budget.cells > 0; --budget.cells) {
      budget.look_around();
      const Cell cell = open_.top();
      const double begin = cell.s.lower(), end = cell.s.upper(), middle = (begin + end) / 2;
      if (!(begin < middle && middle < end)) break;
      open_.pop();
      look_at(Interval(begin, middle));
      look_at(Interval(middle, end));
    }
    for (; !open_.empty(); open_.pop()) take(open_.top());
  }

  void look_at(const Interval& s) {
    const double length = s.upper() - s.lower();
    const Series series = series_on(field_, edge_, s, kOrder);
    const auto r = [&](int k) { return largest(series[k]) * std::pow(length / 2, k); };
    if (2 * r(kOrder) * std::sqrt(length) <= kToleranceOfSmooth * largest_) {
      add(s);
      force += 2 * length * r(kOrder);
      work += 2 * length * r(kOrder - 1);
      value_square_ += length * 4 * r(5) * r(5);
      return;
    }
    const Cell cell{s, series[0]};
    if (cell.radius() * length <= kToleranceOfRough * largest_)
      take(cell);
    else
      open_.push(cell);
  }

  void add(const Interval& s) {
    add(s, [&](double point) { return edge_.value(field_, point); });
  }

  /// By the middle of the values.
  void take(const Cell& cell) {
    is_finite = is_finite && is_known(cell.values);
    if (!is_finite) return;
    add(cell.s, [&](double) { return boost::numeric::median(cell.values); });
    const double off = cell.length() * cell.radius();
    force += off;
    work += off;
    value_square_ += off * cell.radius();
  }

  template <typename Value>
  void add(const Interval& s, const Value& value) {
    const double length = s.upper() - s.lower();
    for (int q = 0; q < EdgeRule::size; ++q) {
      points_.push_back(s.lower() + length * edge_rule().points[q]);
      weights_.push_back(length * edge_rule().weights[q]);
      values_.push_back(value(points_.back()));
    }
  }

  const Field& field_;
  const EdgeLine& edge_;
  const double largest_;
  std::priority_queue<Cell> open_;
  std::vector<double> points_, weights_, values_;
  double value_square_ = 0;
};

}  // namespace

TractionField::TractionField(const Problem& problem, const Mesh& mesh, Progress* progress) {
  const int d = components(problem.material);
  CellBudget budget{kCells, progress};
  const auto loads = [&](const BoundaryPart& part) {
    return condition_on<Traction>(problem, part.name) || condition_on<Pressure>(problem, part.name);
  };
  std::size_t left = 0;
  for (const BoundaryPart& part : mesh.boundary) left += loads(part) ? part.edges.size() : 0;
  for (const BoundaryPart& part : mesh.boundary) {
    if (!loads(part)) continue;
    const Condition& condition = problem.boundary.at(part.name);
    double largest = 0;
    for (const int edge : part.edges) {
      const EdgeLine line(mesh, edge);
      for (const Part& own : parts_of(condition, d, line.normal))
        largest = std::max(largest, std::abs(line.value(own.field, 0.5)));
    }
    for (const int edge : part.edges) {
      const EdgeLine line(mesh, edge);
      const double length = mesh.length(edge);
      ProjectedTraction projected{Eigen::MatrixXd::Zero(d, 3)};
      double rest_square = 0;
      budget.share(left--, [&](CellBudget& of_edge) {
        for (const Part& own : parts_of(condition, d, line.normal)) {
          const EdgeProjection projection(own.field, line, largest, of_edge);
          const double rest = projection.rest();
          projected.balanced += own.vector * projection.nodes.transpose();
          projected.uncertain_force += length * projection.force;
          projected.uncertain_work += length * projection.work;
          // Below this the rest is rounding.
          if (rest > kEnclosureRounding * largest) rest_square += length * rest * rest;
          const bool is_certain = is_known_on_edges(own.field) && projection.is_finite;
          if (!is_certain && unmet_.empty())
            unmet_.push_back(own.field.formula()
                                 ? not_known_to_be_finite(own.field, line.at(0.5))
                                 : own.field.name() + " is a function that is known in single points only");
        }
      });
      projected.rest = std::sqrt(rest_square);
      projected_.emplace(edge, std::move(projected));
    }
  }
}

double TractionField::operator()(int edge, int component, double s) const {
  return projected_.at(edge).balanced.row(component).dot(edge_basis(2, s).transpose());
}

}  // namespace signorini
