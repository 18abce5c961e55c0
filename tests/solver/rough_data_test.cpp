// The bound where data are not smooth: along sides, at points, or nowhere.
#include <gtest/gtest.h>

#include "problems/membrane.hpp"

namespace signorini {
namespace {

/// A square of 4 x 4 squares that lies on its bottom.
Problem square() {
  Problem problem;
  problem.mesh.fineness = Divisions{4, 4};
  problem.scheme = Scheme::conforming;
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{Field(0.05)}}};
  return problem;
}

double relative_bound(const Problem& problem) {
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  const ErrorBound& bound = summary.error_bound.value();
  EXPECT_TRUE(bound.guaranteed) << (bound.unmet.empty() ? "" : bound.unmet.front());
  EXPECT_EQ(summary.outcome, Outcome::converged);
  return bound.relative;
}

double with_load(const std::string& load) {
  Problem problem = square();
  problem.body = problems::formula(load);
  return relative_bound(problem);
}

TEST(RoughData, ALoadWithoutSlopesAlongTwoSidesHasTheBoundOfASmoothOne) {
  EXPECT_LE(with_load("sqrt(x*(1-x))"), 0.016);
  EXPECT_LE(with_load("0.39+0*x"), 0.016);
}

TEST(RoughData, ALoadWithASlopeThatTendsToInfinityIsBounded) {
  EXPECT_LE(with_load("y*log(y+1e-30)"), 0.06);
}

TEST(RoughData, ALoadThatJumpsAlongAHalfLineIsBounded) {
  EXPECT_LE(with_load("atan2(y-0.4123,x-0.63)"), 0.35);
}

/// Next to nothing is known of noise, but that is paid for.
TEST(RoughData, NoiseCostsTheBoundAndNotTheGuarantee) {
  EXPECT_TRUE(std::isfinite(with_load("sin(12345.678*x)*43758.5453-rint(sin(12345.678*x)*43758.5453)-3")));
}

TEST(RoughData, AGapThatFallsFromASupportLikeARootIsMet) {
  Problem problem = square();
  problem.body = Field(-1);
  problem.boundary = {{"left", Fixed{}}, {"right", Fixed{}}, {"bottom", Contact{problems::formula("sqrt(x)")}}};
  EXPECT_LE(relative_bound(problem), 0.45);
}

TEST(RoughData, AMeshRefinesItselfForALoadWithoutSlopes) {
  Problem problem = square();
  problem.body = problems::formula("sqrt(x*(1-x))");
  problem.mesh.adaptive = Adaptive{0.01, 2000};
  EXPECT_LE(relative_bound(problem), 0.01);
}

}  // namespace
}  // namespace signorini
