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

/// Adds the orbits of a symmetric rule; its weights are given for an area of 1.
template <int Points>
class Orbits {
 public:
  RuleOnTriangle<Points> rule{};

  void add(double x, double y, double weight) {
    rule.points[next_] = {x, y};
    rule.weights[next_++] = weight / 2;
  }
  /// (a, a), (1 − 2a, a), (a, 1 − 2a).
  void add_three(double a, double weight) {
    add(a, a, weight);
    add(1 - 2 * a, a, weight);
    add(a, 1 - 2 * a, weight);
  }
  /// All that have two of a, b, 1 − a − b for coordinates.
  void add_six(double a, double b, double weight) {
    const double c = 1 - a - b;
    for (const auto& [x, y] : {std::pair{a, b}, {b, a}, {b, c}, {c, b}, {c, a}, {a, c}}) add(x, y, weight);
  }

 private:
  int next_ = 0;
};

FineTriangleRule dunavant_6() {
  Orbits<12> orbits;
  orbits.add_three(0.24928674517091042129, 0.11678627572637936603);
  orbits.add_three(0.06308901449150222834, 0.050844906370206816921);
  orbits.add_six(0.053145049844816947353, 0.31035245103378440542, 0.082851075618373575194);
  return orbits.rule;
}

FinestTriangleRule dunavant_8() {
  Orbits<16> orbits;
  orbits.add(1. / 3, 1. / 3, 0.14431560767778716825);
  orbits.add_three(0.45929258829272315603, 0.095091634267284624794);
  orbits.add_three(0.17056930775176020663, 0.10321737053471825028);
  orbits.add_three(0.050547228317030975458, 0.032458497623198080310);
  orbits.add_six(0.0083947774099576053372, 0.26311282963463811342, 0.027230314174434994264);
  return orbits.rule;
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
  static const FineTriangleRule rule = dunavant_6();
  return rule;
}

const FinestTriangleRule& finest_triangle_rule() {
  static const FinestTriangleRule rule = dunavant_8();
  return rule;
}

const EdgeRule& edge_rule() {
  static const EdgeRule rule = gauss();
  return rule;
}

}  // namespace signorini
