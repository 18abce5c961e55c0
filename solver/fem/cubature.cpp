#include "fem/cubature.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace signorini {

std::vector<WeightedPoint> composite_rule(int cuts) {
  std::vector<WeightedPoint> rule;
  const auto add = [&](const Point& corner, double side) {
    for (int q = 0; q < TriangleRule::size; ++q)
      rule.push_back({corner + side * triangle_rule().points[q], triangle_rule().weights[q] / (cuts * cuts)});
  };
  for (int i = 0; i < cuts; ++i)
    for (int j = 0; i + j < cuts; ++j) {
      add(Point(i, j) / cuts, 1. / cuts);
      if (i + j + 1 < cuts) add(Point(i + 1, j + 1) / cuts, -1. / cuts);
    }
  return rule;
}

std::vector<WeightedPoint> collapsed_rule(int n) {
  // The zeros of the Legendre polynomial by Newton's method, from Tricomi's estimate.
  std::vector<double> nodes, weights;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 0;
    for (int step = 0; step < 8; ++step) {
      double last = 1, own = x;
      for (int k = 2; k <= n; ++k) last = std::exchange(own, ((2 * k - 1) * x * own - (k - 1) * last) / k);
      slope = n * (x * own - last) / (x * x - 1);
      x -= own / slope;
    }
    nodes.push_back((1 + x) / 2);
    weights.push_back(1 / ((1 - x * x) * slope * slope));
  }
  std::vector<WeightedPoint> rule;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      rule.push_back({Point(nodes[i], (1 - nodes[i]) * nodes[j]), weights[i] * weights[j] * (1 - nodes[i])});
  return rule;
}

namespace {

/// Three points with one weight, the corners of the triangle drawn near to its centroid.
std::vector<WeightedPoint> three_points(double distance, double weight) {
  const double other = 1 - 2 * distance;
  return {{Point(distance, distance), weight},
          {Point(other, distance), weight},
          {Point(distance, other), weight}};
}

/// Strang and Fix (1973), degree 2 with three points and degree 4 with six; all lie inside.
std::vector<WeightedPoint> rule_of_second_degree() {
  return three_points(1. / 6, 1. / 6);
}

std::vector<WeightedPoint> rule_of_fourth_degree() {
  const double root = std::sqrt(10.), of_place = std::sqrt(38 - 44 * std::sqrt(0.4)),
               of_weight = std::sqrt(213125 - 53320 * root);
  std::vector<WeightedPoint> rule = three_points((8 - root + of_place) / 18, (620 + of_weight) / 7440);
  const std::vector<WeightedPoint> others =
      three_points((8 - root - of_place) / 18, (620 - of_weight) / 7440);
  rule.insert(rule.end(), others.begin(), others.end());
  return rule;
}

}  // namespace

const std::vector<WeightedPoint>& rule_of_degree(int degree) {
  static const std::vector<WeightedPoint> two = rule_of_second_degree(), four = rule_of_fourth_degree(),
                                          five = weighted(triangle_rule()),
                                          six = weighted(fine_triangle_rule()),
                                          eight = weighted(finest_triangle_rule()), ten = collapsed_rule(6),
                                          eighteen = collapsed_rule(10), thirty = collapsed_rule(16);
  if (degree <= 2) return two;
  if (degree <= 4) return four;
  if (degree <= 5) return five;
  if (degree <= 6) return six;
  if (degree <= 8) return eight;
  if (degree <= 10) return ten;
  return degree <= 18 ? eighteen : thirty;
}

}  // namespace signorini
