#pragma once

#include <array>

#include "problem/field.hpp"

namespace signorini {

/// Points of the reference triangle (0,0), (1,0), (0,1), all inside it, so that a load that jumps along
/// mesh lines is never evaluated on its jump. The weights sum to the area 1/2.
template <int Points>
struct RuleOnTriangle {
  static constexpr int size = Points;
  std::array<Point, size> points;
  std::array<double, size> weights;
};

using TriangleRule = RuleOnTriangle<7>;
using FineTriangleRule = RuleOnTriangle<12>;
using FinestTriangleRule = RuleOnTriangle<16>;

/// Radon's rule with seven points: exact for polynomials of degree 5 (Stroud, T2: 5-1).
const TriangleRule& triangle_rule();

/// Dunavant's rule with twelve points (1985): exact for polynomials of degree 6.
const FineTriangleRule& fine_triangle_rule();

/// Dunavant's rule with sixteen points: exact for polynomials of degree 8.
const FinestTriangleRule& finest_triangle_rule();

/// Points and weights on [0, 1]; the weights sum to 1.
struct EdgeRule {
  static constexpr int size = 5;
  std::array<double, size> points;
  std::array<double, size> weights;
};

/// Gauss–Legendre with five points: exact for polynomials of degree 9.
const EdgeRule& edge_rule();

}  // namespace signorini
