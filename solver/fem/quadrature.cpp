#include "fem/quadrature.hpp"

#include <cmath>
#include <utility>

namespace signorini {
namespace {

TriangleRule radon() {
  TriangleRule rule{};
  rule.points[0] = {1. / 3, 1. / 3};
  rule.weights[0] = 9. / 80;
  // Two orbits of three points (a, a), (1 − 2a, a), (a, 1 − 2a).
  const double root = std::sqrt(15.);
  int next = 1;
  for (const double sign : {-1., 1.}) {
    const double a = (6 + sign * root) / 21, weight = (155 + sign * root) / 2400;
    for (const Point& x : {Point(a, a), Point(1 - 2 * a, a), Point(a, 1 - 2 * a)}) {
      rule.points[next] = x;
      rule.weights[next++] = weight;
    }
  }
  return rule;
}

FineTriangleRule dunavant() {
  FineTriangleRule rule{};
  int next = 0;
  const auto add = [&](double x, double y, double weight) {
    rule.points[next] = {x, y};
    rule.weights[next++] = weight / 2;
  };
  // Two orbits of three points (a, a), (1 − 2a, a), (a, 1 − 2a), and one of six.
  for (const auto& [a, weight] : {std::pair{0.24928674517091042129, 0.11678627572637936603},
                                  {0.06308901449150222834, 0.050844906370206816921}}) {
    add(a, a, weight);
    add(1 - 2 * a, a, weight);
    add(a, 1 - 2 * a, weight);
  }
  constexpr double a = 0.053145049844816947353, b = 0.31035245103378440542, c = 1 - a - b;
  for (const auto& [x, y] : {std::pair{a, b}, {b, a}, {b, c}, {c, b}, {c, a}, {a, c}})
    add(x, y, 0.082851075618373575194);
  return rule;
}

EdgeRule gauss() {
  EdgeRule rule{};
  const double root = std::sqrt(10. / 7);
  const double inner = std::sqrt(5 - 2 * root) / 3, outer = std::sqrt(5 + 2 * root) / 3;
  const double inner_weight = (322 + 13 * std::sqrt(70.)) / 900;
  const double outer_weight = (322 - 13 * std::sqrt(70.)) / 900;
  const std::array nodes{-outer, -inner, 0., inner, outer};
  const std::array weights{outer_weight, inner_weight, 128. / 225, inner_weight, outer_weight};
  for (int i = 0; i < EdgeRule::size; ++i) {
    rule.points[i] = (1 + nodes[i]) / 2;
    rule.weights[i] = weights[i] / 2;
  }
  return rule;
}

}  // namespace

const TriangleRule& triangle_rule() {
  static const TriangleRule rule = radon();
  return rule;
}

const FineTriangleRule& fine_triangle_rule() {
  static const FineTriangleRule rule = dunavant();
  return rule;
}

const EdgeRule& edge_rule() {
  static const EdgeRule rule = gauss();
  return rule;
}

}  // namespace signorini
