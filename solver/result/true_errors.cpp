#include "true_errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "certify/local_fields.hpp"
#include "fem/lagrange.hpp"

namespace signorini {
namespace {

/// Squares of norms.
struct Squares {
  double displacement = 0, stress = 0, energy_norm = 0;
};

template <int D>
Tensor<D> stress_at(const std::vector<Field>& fields, const Point& x) {
  if constexpr (D == 1) {
    return {fields[0](x), fields[1](x)};
  } else {
    const double shear = fields[2](x);
    return {fields[0](x), shear, shear, fields[1](x)};
  }
}

/// u_h at a point of the reference triangle.
template <int D, typename Coefficients>
Eigen::Matrix<double, D, 1> displacement_at(const LocalVector& basis, const Coefficients& coefficients) {
  Eigen::Matrix<double, D, 1> value = Eigen::Matrix<double, D, 1>::Zero();
  for (int a = 0; a < basis.size(); ++a) value += basis[a] * coefficients.template segment<D>(a * D);
  return value;
}

template <int D>
class Differences {
 public:
  Differences(const Problem& problem, const Exact& exact, const Solution& solution)
      : exact_(exact),
        solution_(solution),
        law_(problem.material),
        stress_(spaces_of(solution.scheme, D), points_of(rule_)) {
    const int order = spaces_of(solution.scheme, D).order;
    for (const WeightedPoint& at : rule_) bases_.push_back(triangle_basis(order, at.point));
  }

  void add(int t, Squares& squares) {
    const AffineMap map(solution_.mesh->corners(t));
    for (int q = 0; q < static_cast<int>(rule_.size()); ++q) {
      const Point x = map(rule_[q].point);
      const double weight = rule_[q].weight * map.determinant;
      if (exact_.displacement) squares.displacement += weight * displacement(t, q, x).squaredNorm();
      if (exact_.stress.empty()) continue;
      const Tensor<D> difference = stress_at<D>(exact_.stress, x) - stress_(q, map, solution_.stress.col(t));
      squares.stress += weight * difference.squaredNorm();
      squares.energy_norm += weight * difference.dot(law_(x).compliance * difference);
    }
  }

 private:
  static std::vector<Point> points_of(const std::vector<WeightedPoint>& rule) {
    std::vector<Point> points;
    for (const WeightedPoint& at : rule) points.push_back(at.point);
    return points;
  }

  Eigen::Matrix<double, D, 1> displacement(int t, int q, const Point& x) const {
    Eigen::Matrix<double, D, 1> difference = -displacement_at<D>(bases_[q], solution_.displacement.col(t));
    for (int c = 0; c < D; ++c) difference[c] += (*exact_.displacement)(c, x);
    return difference;
  }

  const Exact& exact_;
  const Solution& solution_;
  LawField<D> law_;
  const std::vector<WeightedPoint> rule_ = composite_rule(2);
  StressValues<D> stress_;
  std::vector<LocalVector> bases_;
};

template <int D>
Squares integrate(const Problem& problem, const Exact& exact, const Solution& solution, Observer& observer) {
  Squares squares;
  if (!exact.displacement && exact.stress.empty()) return squares;
  Differences<D> differences(problem, exact, solution);
  for (int t = 0; t < static_cast<int>(solution.mesh->triangles.size()); ++t) {
    if (t % 256 == 0 && !observer.keep_going()) throw Cancelled();
    differences.add(t, squares);
  }
  return squares;
}

/// 2 <p*, g − u_n>.
double contact_term(const Problem& problem, const VectorField& u, const Solution& solution) {
  const Mesh& mesh = *solution.mesh;
  std::map<int, EdgePressure> pressures;
  for (const EdgePressure& own : solution.admissible_pressure) pressures.emplace(own.edge, own);
  double sum = 0;
  for (const BoundaryPart& part : mesh.boundary) {
    const auto* contact = condition_on<Contact>(problem, part.name);
    if (!contact) continue;
    for (const int edge : part.edges) {
      const auto found = pressures.find(edge);
      if (found == pressures.end()) continue;
      const auto& [a, b] = mesh.edges[edge];
      const Vector normal = mesh.outward_normal(edge);
      const Vector direction = contact->unit_direction(normal);
      for (int q = 0; q < EdgeRule::size; ++q) {
        const double length = found->second.end - found->second.begin;
        const double s = found->second.begin + length * edge_rule().points[q];
        const Point x = mesh.points[a] + s * (mesh.points[b] - mesh.points[a]);
        const double u_n = solution.components == 1
                               ? -u(0, x, normal)
                               : direction.x() * u(0, x, normal) + direction.y() * u(1, x, normal);
        const Mesh::BoundaryPoint on_arc = mesh.on_boundary(edge, s);
        const double room = std::max(0., contact->gap(on_arc.x, on_arc.normal) - u_n);
        sum += 2 * edge_rule().weights[q] * length * mesh.length(edge) * found->second(s) * room;
      }
    }
  }
  return sum;
}

}  // namespace

TrueErrors true_errors(const Problem& problem, const Exact& exact, const Solution& solution,
                       Observer& observer) {
  const Squares squares = solution.components == 1 ? integrate<1>(problem, exact, solution, observer)
                                                   : integrate<2>(problem, exact, solution, observer);
  TrueErrors errors;
  if (exact.displacement) errors.displacement = std::sqrt(squares.displacement);
  if (!exact.stress.empty()) {
    errors.stress = std::sqrt(squares.stress);
    errors.energy_norm = std::sqrt(squares.energy_norm);
  }
  const Summary& summary = solution.summary;
  if (exact.energy) errors.energy = std::abs(summary.energy - *exact.energy);
  if (exact.energy && errors.energy_norm && summary.error_bound) {
    const double of_displacement = 2 * std::max(0., summary.error_bound->energy_upper - *exact.energy);
    const double of_contact = exact.displacement ? contact_term(problem, *exact.displacement, solution) : 0;
    errors.total = std::sqrt(squares.energy_norm + of_displacement + of_contact);
  }
  return errors;
}

}  // namespace signorini
