#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "fem/scheme.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Integrates visit(t, map, reference point) over all triangles by the seven-point rule.
template <typename Visit>
double integrate(const Solution& solution, const Visit& visit) {
  double sum = 0;
  for (int t = 0; t < static_cast<int>(solution.mesh->triangles.size()); ++t) {
    const AffineMap map(solution.mesh->corners(t));
    for (int q = 0; q < TriangleRule::size; ++q)
      sum += triangle_rule().weights[q] * map.determinant * visit(t, map, triangle_rule().points[q]);
  }
  return sum;
}

/// ‖σ − σ_h‖ in L2.
template <typename Stress>
double stress_error(const Solution& solution, const Stress& exact) {
  const RaviartThomas& element = spaces_of(solution.scheme, solution.components).row;
  return std::sqrt(integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
    return (element.values(map, x) * solution.stress.col(t) - exact(map(x))).squaredNorm();
  }));
}

/// ‖u − u_h‖ in L2; ‖u_h‖ for u = 0.
template <typename Displacement>
double displacement_error(const Solution& solution, const Displacement& exact) {
  const int order = spaces_of(solution.scheme, solution.components).order;
  return std::sqrt(integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
    return std::pow(triangle_basis(order, x).dot(solution.displacement.col(t)) - exact(map(x)), 2);
  }));
}

/// ‖λ − λ_h‖ in L2 of the contact boundary, by the rows' weights.
template <typename Clearance>
double clearance_error(const ContactPart& part, const Clearance& exact) {
  double sum = 0;
  for (std::size_t i = 0; i < part.points.size(); ++i)
    sum += part.weight[i] * std::pow(part.clearance[i] - exact(part.points[i]), 2);
  return std::sqrt(sum);
}

/// The clearance of a contact part where an edge from a to a + way consists of some of its edges, with
/// s ∈ [0, 1] first; else less than two values.
inline std::vector<std::pair<double, double>> clearance_along(const ContactPart& part, const Point& a,
                                                              const Vector& way) {
  constexpr double rounding = 1e-9;
  std::vector<std::pair<double, double>> values;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    const double s = (part.points[i] - a).dot(way) / way.squaredNorm();
    const bool lies_there = (a + s * way - part.points[i]).norm() < rounding * way.norm();
    if (lies_there && s > -rounding && s < 1 + rounding) values.emplace_back(s, part.clearance[i]);
  }
  // Where the part bends, the neighbour has a row in the same point.
  const auto coincide = [](const auto& one, const auto& other) {
    return std::abs(one.first - other.first) < rounding;
  };
  if (values.size() > 2 && coincide(values[0], values[1])) values.erase(values.begin());
  if (values.size() > 2 && coincide(values.back(), *(values.end() - 2))) values.pop_back();
  return values;
}

/// 2 <p*, g − u_n> with p* of the coarse solution and the clearance of the conforming one on a finer mesh.
inline double contact_term(const Solution& coarse, const Solution& fine) {
  double sum = 0;
  for (const EdgePressure& pressure : coarse.admissible_pressure) {
    const auto& [first, second] = coarse.mesh->edges[pressure.edge];
    const Point a = coarse.mesh->points[first];
    const Vector way = coarse.mesh->points[second] - a;
    for (const ContactPart& part : fine.contact) {
      const auto clearance = clearance_along(part, a, way);
      for (std::size_t i = 1; i < clearance.size(); ++i) {
        const auto [begin, from] = clearance[i - 1];
        const auto [end, to] = clearance[i];
        for (int q = 0; q < EdgeRule::size; ++q) {
          const double share = edge_rule().points[q];
          sum += 2 * edge_rule().weights[q] * std::abs(end - begin) * way.norm() *
                 pressure(begin + share * (end - begin)) * (from + share * (to - from));
        }
      }
    }
  }
  return sum;
}

/// The slope of log(error) over log(h) by least squares, for meshes that halve h each time.
inline double rate(const std::vector<double>& errors) {
  const double n = static_cast<double>(errors.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double level = -static_cast<double>(i), size = std::log2(errors[i]);
    x += level, y += size, xx += level * level, xy += level * size;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// The energy, by a solution on a finer mesh.
inline double energy_by(const ErrorBound& fine) {
  return (fine.energy_lower + fine.energy_upper) / 2;
}

/// The left side of the identity for a coarse solution, its root: √(‖σ − σ_h‖² + 2 (J(v) − J(u)) + 2 <p*, g −
/// u_n>). `error`: ‖σ − σ_h‖_C from the finer solution.
inline double left_side(double error, const Solution& coarse, const Solution& fine, double energy) {
  const ErrorBound& bound = coarse.summary.error_bound.value();
  return std::sqrt(error * error + 2 * (bound.energy_upper - energy) + contact_term(coarse, fine));
}

}  // namespace signorini
