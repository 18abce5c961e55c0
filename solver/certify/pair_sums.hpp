#pragma once

#include <cmath>

#include <Eigen/Core>

#include "certify/triangle_sums.hpp"

namespace signorini {

/// What the enclosures of quantities need of a pair, or of what several pairs add up to, on all triangles.
struct PairSums {
  explicit PairSums(int triangles) : gaps(triangles) {}

  void add(int t, const TriangleSums& own) {
    gaps[t] = std::pow(own.norm_of_gap(), 2);
    gap += own.gap;
    strain += own.strain;
    energy += own.energy;
    slack += own.slack + own.rounding * (2 * std::sqrt(own.gap) + own.rounding);
    energy_slack += own.energy_slack;
  }

  Eigen::VectorXd gaps;  ///< ‖C σ* − ε(v)‖²_E by triangles, from above
  double gap = 0;
  double strain = 0, energy = 0;  ///< as in TriangleSums
  double slack = 0, energy_slack = 0;
};

}  // namespace signorini
