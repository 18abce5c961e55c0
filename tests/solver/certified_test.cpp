// The numbers that every answer has in guaranteed intervals, against exact values and what balances them.
#include <cmath>

#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "solve.hpp"

namespace signorini::certified_test {
namespace {

using problems::formula;

Certified certified(const Problem& problem) {
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  EXPECT_TRUE(summary.certified);
  return summary.certified.value_or(Certified{});
}

const CertifiedSupport* of(const Certified& certified, const std::vector<std::string>& parts) {
  const auto found = std::ranges::find(certified.supports, parts, &CertifiedSupport::parts);
  return found == certified.supports.end() ? nullptr : &*found;
}

void expect_near(const EnclosedNumber& number, double exact, double width) {
  EXPECT_LE(number.lower, exact + 1e-12 * std::abs(exact));
  EXPECT_GE(number.upper, exact - 1e-12 * std::abs(exact));
  EXPECT_LE(number.upper - number.lower, width);
  EXPECT_LE(number.lower, number.estimate);
  EXPECT_GE(number.upper, number.estimate);
}

/// A block of width 1 and height 1 on a frictionless floor, which a frictionless wall holds at its left and a
/// foundation above presses by 0.01 and a traction of 3 pulls to the right: all spaces contain the solution.
Problem pressed_block(Scheme scheme, double scale = 1) {
  Problem problem;
  problem.scheme = scheme;
  problem.mesh = MeshRequest(Divisions{4, 4}, Pattern::crossed);
  problem.material = YoungPoisson{Field(200 * scale), Field(0.25), Plane::stress};
  problem.boundary = {{"bottom", Roller{}},
                      {"left", Roller{}},
                      {"right", Traction{VectorField(Field(3 * scale), Field(0))}},
                      {"top", Contact{Field(-0.02)}}};
  return problem;
}

/// σ_xx = 3, ε_yy = −0.02 = (σ_yy − ν σ_xx) / E.
TEST(Certified, IsKnownToRoundingWhereTheSolutionIsExact) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double scale : {1e-9, 1., 1e9}) {
      const Certified all = certified(pressed_block(scheme, scale));
      EXPECT_TRUE(all.unmet.empty());
      const double pressure = (0.02 * 200 - 0.25 * 3) * scale, rounding = 1e-6 * scale;
      ASSERT_EQ(all.supports.size(), 3u);
      const CertifiedSupport &top = *of(all, {"top"}), &left = *of(all, {"left"}),
                             &bottom = *of(all, {"bottom"});
      expect_near(*top.pressure_force, pressure, rounding);
      expect_near(top.force[0], 0, rounding);
      expect_near(top.force[1], -pressure, rounding);
      expect_near(*top.moment, -pressure / 2, rounding);
      expect_near(left.force[0], -3 * scale, rounding);
      expect_near(*left.moment, 1.5 * scale, rounding);
      expect_near(bottom.force[1], pressure, rounding);
      EXPECT_FALSE(bottom.pressure_force);
      // 3 u_x at the right, with ε_xx = (σ_xx − ν σ_yy) / E.
      expect_near(all.work, 3 * (3 * scale + 0.25 * pressure) / 200, 1e-8 * scale);
    }
}

/// The motion of the only support is one of the whole body, so that it takes the loads to rounding.
TEST(Certified, TellsWhatTheOnlySupportTakes) {
  Problem problem;
  problem.scheme = Scheme::nonconforming;
  problem.mesh = MeshRequest(Divisions{5, 5});
  problem.material = YoungPoisson{Field(2), Field(0.3), Plane::strain};
  problem.body = VectorField(formula("3*x"), formula("x < 0.37 ? 2 : -1"));
  problem.boundary = {{"left", Fixed{}}, {"top", Traction{VectorField(Field(1), formula("x^2"))}}};
  const Certified all = certified(problem);
  const CertifiedSupport& left = *of(all, {"left"});
  const double vertical = 2 * 0.37 - 0.63 + 1. / 3;
  // But for what is not known of the load along its jump.
  expect_near(left.force[0], -2.5, 1e-5);
  expect_near(left.force[1], -vertical, 1e-5);
  // ∫ (x f_y − y f_x) = 0.37² − (1 − 0.37²)/2 − 3/4, and of the traction ∫ x³ − 1.
  expect_near(*left.moment, -(0.37 * 0.37 - (1 - 0.37 * 0.37) / 2 - 0.75 + 0.25 - 1), 1e-5);
}

TEST(Certified, TellsOfSupportsThatClashWhatTheyTakeTogether) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  for (auto& [part, condition] : problem.boundary)
    if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = Field(0);
  const Certified all = certified(problem);
  EXPECT_FALSE(all.unmet.empty());
  std::size_t sums = 0;
  for (const CertifiedSupport& support : all.supports) {
    if (support.parts.size() > 1) {
      ++sums;
      EXPECT_TRUE(support.force[0].is_bounded());
      continue;
    }
    EXPECT_FALSE(support.force[0].is_bounded());
    if (!support.pressure_force) continue;
    EXPECT_GT(support.pressure_force->lower, 0.05);
    EXPECT_LT(support.pressure_force->lower, support.pressure_force->value);
    EXPECT_FALSE(support.pressure_force->has_upper());
  }
  EXPECT_EQ(sums, 1u);
}

/// Across the wall nothing else holds the body, and about the corner that it shares with the floor nothing
/// clashes.
TEST(Certified, BoundsWhatDoesNotClashAlone) {
  Problem problem = pressed_block(Scheme::conforming);
  problem.boundary["left"] = Fixed{};
  problem.boundary["top"] = Contact{Field(0.1)};
  const Certified all = certified(problem);
  const CertifiedSupport &left = *of(all, {"left"}), &bottom = *of(all, {"bottom"});
  expect_near(left.force[0], -3, 1e-5);
  EXPECT_TRUE(left.moment);
  EXPECT_FALSE(left.force[1].is_bounded());
  EXPECT_FALSE(bottom.force[1].is_bounded());
  EXPECT_EQ(all.supports.back().parts.size(), 3u);
  expect_near(all.supports.back().force[1], 0, 1e-5);
}

TEST(Certified, HasTheWorkOfTheLoadsFromTheEnergiesAtRest) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  for (auto& [part, condition] : problem.boundary)
    if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = Field(0);
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  EXPECT_DOUBLE_EQ(summary.certified->work.lower, -2 * summary.error_bound->energy_upper);
  EXPECT_DOUBLE_EQ(summary.certified->work.upper, -2 * summary.error_bound->energy_lower);
  EXPECT_DOUBLE_EQ(summary.certified->energy.lower, summary.error_bound->energy_lower);
}

/// p = 3/2 √−x for x < 0, and open beyond: ∫ λ = 2/5 there.
TEST(Certified, SaysWhereAContactSurelyTouches) {
  const Certified all = certified(problems::SignoriniEdge::problem(Scheme::conforming, 32));
  const std::vector<CertifiedStretch>& stretches = of(all, {"bottom"})->stretches;
  ASSERT_EQ(stretches.size(), 8u);
  const auto force = [](double x) { return x < 0 ? -std::pow(-x, 1.5) : 0; };  // ∫ p up to x, but for 1
  const auto opening = [](double x) { return x > 0 ? 0.4 * std::pow(x, 2.5) : 0; };
  bool touches = false, is_tight = false;
  for (const CertifiedStretch& own : stretches) {
    const double a = std::min(own.begin.x(), own.end.x()), b = std::max(own.begin.x(), own.end.x());
    if (own.touches) {
      EXPECT_LT(a, 0);
    }
    touches = touches || own.touches;
    if (own.carries_at_most) {
      EXPECT_GE(*own.carries_at_most, force(b) - force(a));
      is_tight = is_tight || (b <= 0 && *own.carries_at_most < 1.5 * (force(b) - force(a)));
    }
    if (own.opens_at_most) {
      EXPECT_GE(*own.opens_at_most, opening(b) - opening(a));
    }
  }
  EXPECT_TRUE(touches);
  EXPECT_TRUE(is_tight);
}

/// Where a contact of the paper is open, its pressure is rounding of either sign.
TEST(Certified, SaysNothingOfOpeningsUnderAPressureOfRounding) {
  for (const int n : {8, 12, 16}) {
    const Solution solution = solve(problems::paper(Scheme::nonconforming, n), {ActiveSet{}, {}});
    for (const CertifiedSupport& support : solution.summary.certified.value().supports)
      for (const CertifiedStretch& stretch : support.stretches)
        EXPECT_LE(stretch.opens_at_most.value_or(0), 1);
  }
}

TEST(Certified, IsAbsentWhereTheBoundIsNotGuaranteed) {
  Problem problem = pressed_block(Scheme::conforming);
  problem.body = VectorField(
      Field([](const Point& x, const Vector&) { return std::sin(x.x()); }, "/load/body/0"), Field(0));
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  ASSERT_TRUE(summary.error_bound);
  EXPECT_FALSE(summary.error_bound->guaranteed);
  EXPECT_FALSE(summary.certified);
}

}  // namespace
}  // namespace signorini::certified_test
