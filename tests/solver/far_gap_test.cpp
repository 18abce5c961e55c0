// A gap so large that it stands for "never" neither drowns the displacement nor the bound.
#include <limits>

#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "problems/no_cache.hpp"
#include "solve.hpp"

namespace signorini::far_gap_test {
namespace {

Problem membrane(Scheme scheme, double gap) {
  Problem problem = problems::paper(scheme, 8);
  problem.body = problems::formula("x < 0.5 ? 1 : -1");
  problem.boundary = {
      {"left", Fixed{}}, {"right", Contact{0.1}}, {"bottom", Contact{gap}}, {"top", Contact{0.}}};
  return problem;
}

Problem elastic(Scheme scheme, double gap) {
  Problem problem = problems::block(scheme, Pattern::right, 200, 0.3);
  problem.body = VectorField(0.5, -1);
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{gap}}, {"right", Contact{0.001}}};
  return problem;
}

using Pose = Problem (*)(Scheme, double);

void expect_same(Pose pose, const Method& method, Scheme scheme, double far) {
  const Solution one = solve(pose(scheme, 3.), {method, {}}), other = solve(pose(scheme, far), {method, {}});
  EXPECT_EQ(other.summary.outcome, Outcome::converged);
  EXPECT_NEAR(other.summary.energy, one.summary.energy, 1e-8 * std::abs(one.summary.energy));
  EXPECT_NEAR(other.summary.contact.force, one.summary.contact.force, 1e-6 * one.summary.contact.force);
  if (far < 1e14) {
    const ErrorBound &near_bound = one.summary.error_bound.value(),
                     &far_bound = other.summary.error_bound.value();
    EXPECT_TRUE(far_bound.guaranteed);
    EXPECT_NEAR(far_bound.value, near_bound.value, 0.02 * near_bound.value);
    EXPECT_NEAR(far_bound.energy_upper, near_bound.energy_upper, 1e-5 * std::abs(near_bound.energy_upper));
  } else if (other.summary.error_bound) {
    // A pressure that is rounding works over such a gap.
    EXPECT_TRUE(other.summary.error_bound->guaranteed);
  }
  for (const ContactPart& part : other.contact)
    if (part.name == "bottom")
      for (std::size_t i = 0; i < part.gap.size(); ++i) {
        EXPECT_NEAR(part.gap[i], far, 1e-12 * far);
        EXPECT_NEAR(part.clearance[i], far, 1 + 1e-12 * far);
      }
}

TEST(FarGap, WorksAsWellAsANearOneThatIsNeverMet) {
  for (const Pose pose : {&membrane, &elastic})
    for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
      for (const double gap : {1e2, 1e5, 1e9, 1e14, 1e300, std::numeric_limits<double>::max()})
        for (const Method& method : {Method(Mprgp{}), Method(ActiveSet{})}) {
          SCOPED_TRACE(gap);
          expect_same(pose, method, scheme, gap);
        }
}

/// Loads that are small beside gaps and stiffness by as many powers of ten as one likes, or none at all.
TEST(FarGap, LetsHardlyLoadedBodiesRest) {
  const auto summary = [](Scheme scheme, const Method& method, double load, double gap) {
    Problem problem = problems::block(scheme, Pattern::right, 1, 0.3);
    problem.body = VectorField(0.5 * load, -load);
    problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{gap}}, {"right", Contact{gap}}};
    return solve(problem, {method, {}}).summary;
  };
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Method& method : {Method(Mprgp{}), Method(ActiveSet{})}) {
      const double energy = summary(scheme, method, 1, 1e3).energy;
      for (const double load : {1e-20, 1e-60, 0.}) {
        const Summary own = summary(scheme, method, load, 0.06);
        EXPECT_EQ(own.outcome, Outcome::converged) << load;
        EXPECT_NEAR(own.energy, load * load * energy, 1e-6 * load * load * std::abs(energy)) << load;
        EXPECT_EQ(own.contact.length, 0) << load;
        EXPECT_TRUE(own.error_bound->guaranteed) << load;
      }
    }
}

/// The foundation that is far at first is met after a variation, and the other way round.
TEST(FarGap, InASweep) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = elastic(scheme, 1e9);
    problem.load_key = "the load of all";
    const auto variation = [&](double gap) {
      return Variation{"", problem.body, elastic(scheme, gap).boundary, problem.load_key};
    };
    const std::vector<Variation> sweep{variation(1e-5), variation(1e9), variation(1e-5)};
    const std::vector<double> gaps{1e-5, 1e9, 1e-5};
    NoCache cache;
    Observer observer;
    const Solution solution = solve(problem, sweep, {ActiveSet{}, {}}, observer, cache);
    ASSERT_EQ(solution.sweep.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const Solution alone = solve(elastic(scheme, gaps[i]), {ActiveSet{}, {}});
      EXPECT_EQ(solution.sweep[i].error, "");
      EXPECT_EQ(solution.sweep[i].outcome, Outcome::converged);
      EXPECT_NEAR(solution.sweep[i].energy, alone.summary.energy, 1e-8 * std::abs(alone.summary.energy));
      EXPECT_NEAR(solution.sweep[i].sums.force, alone.summary.contact.force,
                  1e-6 * alone.summary.contact.force);
    }
  }
}

}  // namespace
}  // namespace signorini::far_gap_test
