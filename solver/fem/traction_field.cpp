#include "fem/traction_field.hpp"

#include <algorithm>
#include <cmath>

#include "fem/edge_pieces.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"

namespace signorini {
namespace {

/// What an integral may be off by, relative to the largest traction.
constexpr double kTolerance = 1e-9;

/// A scalar on an edge times a fixed vector.
struct Part {
  const Field& field;
  Eigen::VectorXd vector;
};

std::vector<Part> parts_of(const Condition& condition, int components, const Vector& normal) {
  if (const auto* pressure = std::get_if<Pressure>(&condition)) return {{pressure->value, -normal}};
  std::vector<Part> parts;
  if (const auto* traction = std::get_if<Traction>(&condition))
    for (int c = 0; c < traction->value.size(); ++c)
      parts.push_back({traction->value.fields()[c], Eigen::VectorXd::Unit(components, c)});
  return parts;
}

/// A scalar on an edge in the points of Gauss on each of some pieces, with what the sums are off by.
class Projection {
 public:
  Projection(const Field& field, const EdgeLine& edge, double largest, CellBudget& budget) {
    if (field.formula())
      cut(field, edge, Interval(0, 1), kTolerance * largest, budget);
    else
      add(field, edge, Interval(0, 1));
    LocalVector moments = LocalVector::Zero(3);
    for (std::size_t q = 0; q < points_.size(); ++q) moments += weights_[q] * values_[q] * edge_basis(2, points_[q]);
    nodes = project_onto_edge(2, moments);
  }

  Eigen::Vector3d nodes;
  double force = 0, work = 0;

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

  void cut(const Field& field, const EdgeLine& edge, const Interval& s, double allowed, CellBudget& budget) {
    const double length = s.upper() - s.lower(), half = length / 2, middle = (s.lower() + s.upper()) / 2;
    const Series series = series_on(field, edge, s, kOrder);
    const auto r = [&](int k) { return largest(series[k]) * std::pow(half, k); };
    if (2 * r(kOrder) * std::sqrt(length) <= allowed) {
      add(field, edge, s);
      force += 2 * length * r(kOrder);
      work += 2 * length * r(kOrder - 1);
      value_square_ += length * 4 * r(5) * r(5);
      return;
    }
    const double uncertain = series[0].upper() - series[0].lower();
    const bool is_small = uncertain * std::sqrt(length) <= allowed || !(s.lower() < middle && middle < s.upper());
    if (is_small || budget.cells-- <= 0) {
      add(field, edge, s);
      force += length * uncertain;
      work += length * uncertain;
      value_square_ += length * uncertain * uncertain;
      return;
    }
    cut(field, edge, Interval(s.lower(), middle), allowed, budget);
    cut(field, edge, Interval(middle, s.upper()), allowed, budget);
  }

  void add(const Field& field, const EdgeLine& edge, const Interval& s) {
    const double length = s.upper() - s.lower();
    for (int q = 0; q < EdgeRule::size; ++q) {
      points_.push_back(s.lower() + length * edge_rule().points[q]);
      weights_.push_back(length * edge_rule().weights[q]);
      values_.push_back(edge.value(field, points_.back()));
    }
  }

  std::vector<double> points_, weights_, values_;
  double value_square_ = 0;
};

}  // namespace

TractionField::TractionField(const Problem& problem, const Mesh& mesh, Progress* progress) {
  const int d = components(problem.material);
  CellBudget budget{100'000, progress};
  for (const BoundaryPart& part : mesh.boundary) {
    const auto found = problem.boundary.find(part.name);
    if (found == problem.boundary.end()) continue;
    const Condition& condition = found->second;
    if (!std::holds_alternative<Traction>(condition) && !std::holds_alternative<Pressure>(condition)) continue;
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
      for (const Part& own : parts_of(condition, d, line.normal)) {
        const Projection projection(own.field, line, largest, budget);
        const double rest = projection.rest();
        projected.balanced += own.vector * projection.nodes.transpose();
        projected.uncertain_force += length * projection.force;
        projected.uncertain_work += length * projection.work;
        // Below this the rest is rounding.
        if (rest > kEnclosureRounding * largest) rest_square += length * rest * rest;
        const bool is_certain = is_known_on_edges(own.field) && std::isfinite(projection.work);
        if (!is_certain && unmet_.empty())
          unmet_.push_back(own.field.name() + (own.field.formula()
                                                   ? " is not known to be finite near " + to_string(line.at(0.5))
                                                   : " is a function that is known in single points only"));
      }
      projected.rest = std::sqrt(rest_square);
      projected_.emplace(edge, std::move(projected));
    }
  }
}

double TractionField::operator()(int edge, int component, double s) const {
  return projected_.at(edge).balanced.row(component).dot(edge_basis(2, s).transpose());
}

}  // namespace signorini
