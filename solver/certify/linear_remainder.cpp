#include "certify/linear_remainder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// The least of constant(reference, first, det B) times the norms of B over the maps of the reference
/// triangles, corner 0 to the corner named first.
template <int D, typename Constant>
double least_of_maps(const std::array<Point, 3>& corners, const Constant& constant) {
  double least = std::numeric_limits<double>::infinity();
  for (const ReferenceTriangle& reference : reference_triangles()) {
    const Eigen::Matrix2d back = jacobian(reference.corners, 0).inverse();
    for (int first = 0; first < 3; ++first) {
      const Eigen::Matrix2d b = jacobian(corners, first) * back;
      // The singular values s ≥ t have s² + t² = |B|² and s t = det B.
      const double square = b.squaredNorm(), det = b.determinant();
      const double s = (std::sqrt(square + 2 * det) + std::sqrt(std::max(0., square - 2 * det))) / 2;
      least = std::min(least, constant(reference, first, det) * (D == 1 ? s : s * s * s / det));
    }
  }
  return least;
}

}  // namespace

template <int D>
double linear_remainder(const std::array<Point, 3>& corners) {
  return least_of_maps<D>(
      corners, [](const ReferenceTriangle& reference, int, double) { return reference.constants(D).load; });
}

template <int D>
double linear_remainder_on_edge(const std::array<Point, 3>& corners, int e) {
  return least_of_maps<D>(corners, [&](const ReferenceTriangle& reference, int first, double determinant) {
    const int own = (e + 3 - first) % 3;
    return reference.constants(D).on_edges[own] *
           std::sqrt(length(corners, e) / length(reference.corners, own) / determinant);
  });
}

template double linear_remainder<1>(const std::array<Point, 3>&);
template double linear_remainder<2>(const std::array<Point, 3>&);
template double linear_remainder_on_edge<1>(const std::array<Point, 3>&, int);
template double linear_remainder_on_edge<2>(const std::array<Point, 3>&, int);

const std::array<ReferenceTriangle, 2>& reference_triangles() {
  static const std::array<ReferenceTriangle, 2> references{
      ReferenceTriangle{
          {Point(0, 0), Point(1, 0), Point(0, 1)}, {0.177, {0.59, 0.465, 0.465}}, {0.54, {1.81, 1.44, 1.44}}},
      ReferenceTriangle{{Point(0, 0), Point(1, 0), Point(0.5, std::sqrt(0.75))},
                        {0.139, {0.459, 0.459, 0.459}},
                        {0.343, {1.01, 1.01, 1.01}}}};
  return references;
}

}  // namespace signorini
