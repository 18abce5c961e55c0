#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "solve.hpp"

namespace signorini {

/// Expects two solutions of a problem to differ by no more than 1e-10 of their largest values; clearance
/// and pressure, which may be zero, of those of displacement and stress.
inline void expect_same_answers(const Solution& one, const Solution& other) {
  constexpr double rounding = 1e-10;
  const auto largest = [](const auto& values) {
    return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0.;
  };
  const auto expect_near = [&](const auto& a, const auto& b, const char* what, double size = 0) {
    ASSERT_EQ(a.size(), b.size()) << what;
    EXPECT_LE(largest(a - b), rounding * std::max(size, largest(b))) << what;
  };
  EXPECT_EQ(one.summary.outcome, other.summary.outcome);
  EXPECT_EQ(one.summary.iterations, other.summary.iterations);
  EXPECT_NEAR(one.summary.energy / other.summary.energy, 1, rounding);
  expect_near(one.stress, other.stress, "stress");
  expect_near(one.displacement, other.displacement, "displacement");
  expect_near(one.rotation, other.rotation, "rotation");
  ASSERT_EQ(one.contact.size(), other.contact.size());
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  };
  for (std::size_t part = 0; part < one.contact.size(); ++part) {
    EXPECT_EQ(one.contact[part].open, other.contact[part].open);
    expect_near(vector(one.contact[part].clearance), vector(other.contact[part].clearance), "clearance",
                largest(other.displacement));
    expect_near(vector(one.contact[part].pressure), vector(other.contact[part].pressure), "pressure",
                largest(other.stress_at_centroids));
  }
  ASSERT_EQ(one.summary.error_bound.has_value(), other.summary.error_bound.has_value());
  if (one.summary.error_bound) {
    // What relaxes the admissible fields of an elastic body ends by a tolerance of its own; where the
    // solution is exact, the bound is a root of rounding.
    const double relative = other.summary.error_bound->relative;
    EXPECT_NEAR(one.summary.error_bound->relative, relative, 1e-4 * relative + 1e-7);
  }
}

}  // namespace signorini
