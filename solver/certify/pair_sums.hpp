#pragma once

#include <cmath>

#include <Eigen/Core>

#include "certify/triangle_sums.hpp"

namespace signorini {

/// What the enclosures of quantities need of a pair, or of what several pairs add up to, in all of some
/// triangles.
struct PairTotals {
  void add(const TriangleSums& own) {
    gap += own.gap;
    strain += own.strain;
    energy += own.energy;
    slack += own.slack + own.rounding * (2 * std::sqrt(own.gap) + own.rounding);
    energy_slack += own.energy_slack;
  }

  PairTotals& operator+=(const PairTotals& other) {
    gap += other.gap;
    strain += other.strain;
    energy += other.energy;
    slack += other.slack;
    energy_slack += other.energy_slack;
    return *this;
  }

  double gap = 0;
  double strain = 0, energy = 0;  ///< as in TriangleSums
  double slack = 0, energy_slack = 0;
};

/// The same on all triangles.
struct PairSums : PairTotals {
  explicit PairSums(int triangles) : gaps(triangles) {}

  Eigen::VectorXd gaps;  ///< ‖C σ* − ε(v)‖²_E by triangles, from above
};

/// That of one triangle.
inline double gap_from_above(const TriangleSums& own) {
  return std::pow(own.norm_of_gap(), 2);
}

}  // namespace signorini
