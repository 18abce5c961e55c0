#pragma once

#include <vector>

#include "fem/quadrature.hpp"

namespace signorini {

/// A point of the reference triangle with its weight.
struct WeightedPoint {
  Point point;
  double weight;
};

/// The triangle rule on each of cuts² similar triangles; 1 is the rule itself.
std::vector<WeightedPoint> composite_rule(int cuts);

template <int Points>
std::vector<WeightedPoint> weighted(const RuleOnTriangle<Points>& rule) {
  std::vector<WeightedPoint> all;
  for (int q = 0; q < Points; ++q) all.push_back({rule.points[q], rule.weights[q]});
  return all;
}

/// n² points, of Gauss and Legendre along x and along the lines from the corner (1, 0): exact for polynomials
/// of degree 2n − 2.
std::vector<WeightedPoint> collapsed_rule(int n);

/// The rules that are exact for the degree, the smallest of them.
const std::vector<WeightedPoint>& rule_of_degree(int degree);

}  // namespace signorini
