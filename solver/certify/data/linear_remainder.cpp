#include "certify/data/linear_remainder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

namespace signorini {
namespace {

Eigen::Matrix2d jacobian(const std::array<Point, 3>& corners, int first) {
  Eigen::Matrix2d jacobian;
  jacobian << corners[(first + 1) % 3] - corners[first], corners[(first + 2) % 3] - corners[first];
  return jacobian;
}

double length(const std::array<Point, 3>& corners, int e) {
  return (corners[(e + 2) % 3] - corners[(e + 1) % 3]).norm();
}

/// ‖B‖, and ‖B‖² ‖B⁻¹‖ for an elastic body: what a constant of loads grows by.
template <int D>
double growth(const ReferenceMap& map) {
  return D == 1 ? map.stretch : std::pow(map.stretch, 3) / map.jacobian.determinant();
}

/// The map with the least constant(reference triangle, map), and that constant.
template <typename Constant>
std::pair<ReferenceMap, double> least_of_maps(const std::array<Point, 3>& corners, const Constant& constant) {
  std::pair<ReferenceMap, double> best{{}, std::numeric_limits<double>::infinity()};
  for (int reference = 0; reference < 2; ++reference) {
    const ReferenceTriangle& triangle = reference_triangles()[reference];
    const Eigen::Matrix2d back = jacobian(triangle.corners, 0).inverse();
    for (int first = 0; first < 3; ++first) {
      ReferenceMap map{reference, first, jacobian(corners, first) * back};
      // The singular values s ≥ t have s² + t² = |B|² and s t = det B.
      const double square = map.jacobian.squaredNorm(), det = map.jacobian.determinant();
      map.stretch = (std::sqrt(square + 2 * det) + std::sqrt(std::max(0., square - 2 * det))) / 2;
      if (const double own = constant(triangle, map); own < best.second) best = {map, own};
    }
  }
  return best;
}

template <int D>
std::pair<ReferenceMap, double> least_of_loads(const std::array<Point, 3>& corners) {
  return least_of_maps(corners, [](const ReferenceTriangle& reference, const ReferenceMap& map) {
    return reference.constants(D).load * growth<D>(map);
  });
}

}  // namespace

template <int D>
ReferenceMap nearest_reference(const std::array<Point, 3>& corners) {
  return least_of_loads<D>(corners).first;
}

template <int D>
double linear_remainder(const std::array<Point, 3>& corners) {
  return least_of_loads<D>(corners).second;
}

template <int D>
double linear_remainder_on_edge(const std::array<Point, 3>& corners, int e) {
  const auto constant = [&](const ReferenceTriangle& reference, const ReferenceMap& map) {
    const int own = (e + 3 - map.first) % 3;
    return reference.constants(D).on_edges[own] * growth<D>(map) *
           std::sqrt(length(corners, e) / length(reference.corners, own) / map.jacobian.determinant());
  };
  return least_of_maps(corners, constant).second;
}

template <int D>
MotionRemainder motion_remainder(const std::array<Point, 3>& corners) {
  const ReferenceMap map = nearest_reference<D>(corners);
  const ReferenceTriangle& reference = reference_triangles()[map.reference];
  const MotionRemainder& known = reference.constants(D).motion;
  MotionRemainder own{known.on_triangle * growth<D>(map), {}};
  for (int e = 0; e < 3; ++e) {
    const int there = (e + 3 - map.first) % 3;
    own.on_edges[e] =
        known.on_edges[there] * growth<D>(map) *
        std::sqrt(length(corners, e) / length(reference.corners, there) / map.jacobian.determinant());
  }
  return own;
}

template ReferenceMap nearest_reference<1>(const std::array<Point, 3>&);
template ReferenceMap nearest_reference<2>(const std::array<Point, 3>&);
template double linear_remainder<1>(const std::array<Point, 3>&);
template double linear_remainder<2>(const std::array<Point, 3>&);
template double linear_remainder_on_edge<1>(const std::array<Point, 3>&, int);
template double linear_remainder_on_edge<2>(const std::array<Point, 3>&, int);
template MotionRemainder motion_remainder<1>(const std::array<Point, 3>&);
template MotionRemainder motion_remainder<2>(const std::array<Point, 3>&);

const std::array<ReferenceTriangle, 2>& reference_triangles() {
  static const std::array<ReferenceTriangle, 2> references{
      ReferenceTriangle{{Point(0, 0), Point(1, 0), Point(0, 1)},
                        {0.177, {0.59, 0.465, 0.465}, {0.32, {0.87, 0.755, 0.755}}},
                        {0.54, {1.81, 1.44, 1.44}, {0.62, {2.41, 2.06, 2.06}}}},
      ReferenceTriangle{{Point(0, 0), Point(1, 0), Point(0.5, std::sqrt(0.75))},
                        {0.139, {0.459, 0.459, 0.459}, {0.241, {0.66, 0.66, 0.66}}},
                        {0.343, {1.01, 1.01, 1.01}, {0.384, {1.48, 1.48, 1.48}}}}};
  return references;
}

}  // namespace signorini
