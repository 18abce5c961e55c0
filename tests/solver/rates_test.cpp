// Orders of convergence on the Signorini edge, fitted over four uniform refinements.
#include <gtest/gtest.h>

#include "norms.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"

namespace signorini::rates_test {
namespace {

using problems::SignoriniEdge;

struct Rates {
  double stress, displacement, clearance;
};

Rates observe(Scheme scheme) {
  std::vector<double> stress, displacement, clearance;
  for (const int n : {8, 16, 32, 64, 128}) {
    const Solution solution = solve(SignoriniEdge::problem(scheme, n), {ActiveSet{}, {}});
    stress.push_back(stress_error(solution, SignoriniEdge::stress));
    displacement.push_back(displacement_error(solution, SignoriniEdge::u));
    clearance.push_back(clearance_error(solution.contact.front(), SignoriniEdge::u));
  }
  const Rates rates{rate(stress), rate(displacement), rate(clearance)};
  testing::Test::RecordProperty("stress", std::to_string(rates.stress));
  testing::Test::RecordProperty("displacement", std::to_string(rates.displacement));
  testing::Test::RecordProperty("clearance", std::to_string(rates.clearance));
  std::printf("observed rates: stress %.3f, displacement %.3f, clearance %.3f\n", rates.stress,
              rates.displacement, rates.clearance);
  return rates;
}

TEST(Rates, NonconformingOnTheSignoriniEdge) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  const Rates rates = observe(Scheme::nonconforming);
  EXPECT_GE(rates.stress, 0.95);
  EXPECT_GE(rates.displacement, 0.5);  // Theorem 4.5
  EXPECT_GE(rates.clearance, 0.5);
}

TEST(Rates, ConformingOnTheSignoriniEdge) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  const Rates rates = observe(Scheme::conforming);
  EXPECT_GE(rates.stress, 1.4);
  EXPECT_GE(rates.displacement, 0.75);  // Theorem 4.3
  EXPECT_GE(rates.clearance, 0.75);
}

TEST(Rates, PressureOfTheSignoriniEdge) {
  const Solution solution = solve(SignoriniEdge::problem(Scheme::conforming, 64), {ActiveSet{}, {}});
  const ContactPart& floor = solution.contact.front();
  for (std::size_t i = 1; i + 1 < floor.points.size(); ++i) {
    const double x = floor.points[i].x();
    if (std::abs(x) < 3. / 64) continue;
    EXPECT_EQ(floor.open[i], x > 0) << x;
    EXPECT_NEAR(floor.pressure[i], x < 0 ? 1.5 * std::sqrt(-x) : 0, 2e-3) << x;
  }
}

}  // namespace
}  // namespace signorini::rates_test
