// A foundation that reaches into the body, beside what holds the body: no displacement of finite energy
// jumps.
#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "solve.hpp"

namespace signorini::overlap_test {
namespace {

constexpr std::array kSchemes{Scheme::conforming, Scheme::nonconforming};

/// Its bottom has two parts along one line.
Problem block(Scheme scheme, double unit = 1) {
  Problem problem;
  problem.domain = Polygon{{{0, 0}, {unit, 0}, {2 * unit, 0}, {2 * unit, unit}, {0, unit}},
                           {},
                           {"bottom", "below", "right", "top", "left"}};
  problem.mesh = MeshRequest(LargestEdge{0.5 * unit});
  problem.material = YoungPoisson{1, 0.3, Plane::strain};
  problem.scheme = scheme;
  return problem;
}

void expect_refused(const Problem& problem, const std::string& by) {
  const std::vector<Fault> faults = validate(problem);
  ASSERT_EQ(faults.size(), 1u) << by;
  EXPECT_EQ(faults[0].where, "/boundary/bottom/gap");
  EXPECT_NE(faults[0].detail.find(by), std::string::npos) << faults[0].detail;
  EXPECT_THROW(solve(problem), InvalidProblem);
}

void expect_solved(const Problem& problem) {
  EXPECT_TRUE(validate(problem).empty());
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  EXPECT_EQ(summary.outcome, Outcome::converged);
  EXPECT_TRUE(summary.error_bound.value().guaranteed) << summary.error_bound->unmet.at(0);
}

TEST(Overlap, BesideAFixedPartIsRefused) {
  for (const Scheme scheme : kSchemes)
    for (const double unit : {1e-9, 1., 1e9}) {
      Problem elastic = block(scheme, unit);
      elastic.boundary = {{"left", Fixed{}}, {"bottom", Contact{-0.1 * unit}}};
      expect_refused(elastic, "fixed part");
      elastic.boundary = {{"below", Fixed{}}, {"bottom", Contact{-0.1 * unit}}};
      expect_refused(elastic, "fixed part");
      Problem membrane = problems::paper(scheme, 4);
      membrane.boundary = {{"left", Fixed{}}, {"bottom", Contact{-0.1 * unit}}};
      expect_refused(membrane, "fixed part");
    }
}

TEST(Overlap, BesideARollerAlongTheSameLineIsRefused) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = block(scheme);
    problem.boundary = {
        {"left", Fixed{}}, {"below", Roller{}}, {"bottom", Contact{problems::formula("-0.1*x")}}};
    expect_refused(problem, "roller");
  }
}

TEST(Overlap, BesideARollerAroundACornerIsMet) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = block(scheme);
    problem.body = VectorField(0, -1);
    problem.boundary = {{"left", Roller{}}, {"bottom", Contact{-0.1}}, {"below", Contact{-0.1}}};
    expect_solved(problem);
  }
}

TEST(Overlap, ThatAFixedPartFollowsIsMet) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = block(scheme);
    problem.boundary = {{"left", Fixed{VectorField(0, 0.1)}}, {"bottom", Contact{-0.1}}};
    expect_solved(problem);
    problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{problems::formula("-0.1*x")}}};
    expect_solved(problem);
  }
}

/// The value in a single point does not count.
TEST(Overlap, InTheFixedPointAloneIsNone) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = block(scheme);
    problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{problems::formula("x <= 0 ? -1 : 0.1")}}};
    expect_solved(problem);
  }
}

}  // namespace
}  // namespace signorini::overlap_test
