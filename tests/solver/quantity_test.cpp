// Intervals of quantities against exact values, against each other, and against much finer meshes.
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "certify/data/oscillation.hpp"
#include "problems/elasticity.hpp"
#include "problems/families.hpp"
#include "problems/long_tests.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"
#include "problems/seconds_at_work.hpp"
#include "result/summarize.hpp"
#include "run/dual_solution.hpp"
#include "run/requested_mesh.hpp"
#include "solve.hpp"

namespace signorini::quantity_test {
namespace {

using problems::digits;
using problems::formula;
using problems::SignoriniEdge;

Quantity pressure_force(const std::string& part, const Field& weight) {
  Quantity quantity;
  quantity.name = "pressure on " + part;
  quantity.weights = {{part, weight}};
  return quantity;
}

Quantity reaction(const std::string& part, const SupportMotion& motion) {
  Quantity quantity;
  quantity.name = "reaction of " + part;
  quantity.motions = {{part, motion}};
  return quantity;
}

Quantity opening(const std::string& part, const Field& weight) {
  Quantity quantity;
  quantity.name = "opening of " + part;
  quantity.openings = {{part, weight}};
  return quantity;
}

Quantity mean_on(const std::string& part, const VectorField& density) {
  Quantity quantity;
  quantity.name = "displacement of " + part;
  quantity.densities = {{part, density}};
  return quantity;
}

Quantity mean_in(const std::string& name, const VectorField& density) {
  Quantity quantity;
  quantity.name = name;
  quantity.density = density;
  return quantity;
}

std::vector<EnclosedQuantity> enclosed(const Problem& problem) {
  return solve(problem, {ActiveSet{}, {}}).summary.quantities;
}

Problem block(Scheme scheme, int n) {
  Problem problem = problems::hanging_block(scheme, n);
  problem.quantities = {pressure_force("bottom", Field(1))};
  return problem;
}

/// A peak of the foundation that the mesh does not see leaves the quantity by itself with [0, 1e86].
TEST(QuantityOfAContact, IsNoWiderThanWhatThatSurelyTakes) {
  for (const double weight : {1., -2.5}) {
    Problem problem = problems::paper(Scheme::nonconforming, 8);
    problem.body = {};
    problem.boundary = {{"top", Fixed{}},
                        {"bottom", Contact{problems::formula("1 - 1.1*max(0, 1 - 1e4*abs(x - 0.31234))")}}};
    problem.quantities = {pressure_force("bottom", Field(weight))};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    const EnclosedQuantity& own = solution.summary.quantities.at(0);
    const EnclosedNumber* force = nullptr;
    for (const CertifiedSupport& support : solution.summary.certified.value().supports)
      if (support.pressure_force && support.parts[0] == "bottom") force = &*support.pressure_force;
    ASSERT_NE(force, nullptr);
    EXPECT_TRUE(own.guaranteed);
    constexpr double rounding = 1 + 1e-15;
    EXPECT_GE(own.lower, std::min(weight * force->lower, weight * force->upper) * rounding);
    EXPECT_LE(own.upper, std::max(weight * force->lower, weight * force->upper) * rounding);
    EXPECT_LT(own.upper - own.lower, 1);
  }
}

struct Goal {
  Scheme scheme;
  int divisions;
  double width;
};

class QuantityOfTheEdge : public testing::TestWithParam<Goal> {};

/// p = 3/2 √−x for x < 0, so that ∫ (1 − |x|) p = 2/5.
TEST_P(QuantityOfTheEdge, IsEnclosedClosely) {
  const auto [scheme, n, width] = GetParam();
  Problem problem = SignoriniEdge::problem(scheme, n);
  problem.quantities = {pressure_force("bottom", formula("1 - abs(x)"))};
  const EnclosedQuantity force = enclosed(problem).at(0);
  EXPECT_TRUE(force.guaranteed) << (force.unmet.empty() ? "" : force.unmet.front());
  EXPECT_LE(force.lower, 0.4);
  EXPECT_GE(force.upper, 0.4);
  EXPECT_LE((force.upper - force.lower) / 0.4, width);
  EXPECT_GE(force.estimate, force.lower);
  EXPECT_LE(force.estimate, force.upper);
}

INSTANTIATE_TEST_SUITE_P(
    Schemes, QuantityOfTheEdge,
    testing::Values(Goal{Scheme::conforming, 16, 4e-3},
                    Goal{Scheme::conforming, sanitized ? 32 : 128, 1e-4 * (sanitized ? 16 : 1)},
                    Goal{Scheme::nonconforming, 16, 0.1},
                    Goal{Scheme::nonconforming, sanitized ? 32 : 128, 0.01 * (sanitized ? 4 : 1)}));

TEST(QuantityOfABlock, HasWidthsThatFallFasterThanTheBound) {
  std::vector<double> widths, bounds;
  double lower = 0, upper = 10;
  for (const int n : {8, 16, 32, 64}) {
    if (sanitized && n == 64) continue;
    const Summary summary = solve(block(Scheme::conforming, n), {ActiveSet{}, {}}).summary;
    const EnclosedQuantity& force = summary.quantities.at(0);
    ASSERT_TRUE(force.guaranteed);
    lower = std::max(lower, force.lower);
    upper = std::min(upper, force.upper);
    widths.push_back(force.relative_width());
    bounds.push_back(summary.error_bound->relative);
  }
  EXPECT_LE(lower, upper);  // all contain the truth
  EXPECT_LE(widths[1], 0.025);
  if (!sanitized) {
    EXPECT_LE(widths[3], 0.006);
  }
  EXPECT_GE(std::log(widths.front() / widths.back()), 1.25 * std::log(bounds.front() / bounds.back()));
}

TEST(QuantityOfABlock, IsForeseenInMemory) {
  if (sanitized) GTEST_SKIP() << "memory is counted without sanitizers";
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Problem problem = block(scheme, 64);
    const auto peak = static_cast<double>(solve(problem, {ActiveSet{}, {}}).summary.peak_memory_bytes);
    EXPECT_LE(peak, estimate(problem).memory_bytes);
    EXPECT_GE(2 * peak, estimate(problem).memory_bytes);
  }
}

/// By whoever asks for an estimate, within a factor that machines differ by.
TEST(QuantityOfABlock, IsForeseenInSeconds) {
  if (sanitized) GTEST_SKIP() << "sanitizers take time";
  const auto seconds = [](const Problem& problem) {
    const double begin = seconds_at_work();
    solve(problem, {ActiveSet{}, {}});
    return seconds_at_work() - begin;
  };
  Quantity in_disc = mean_in("disc", VectorField(Field(0), formula("(x-0.3)^2 + (y-0.3)^2 < 0.04 ? 8 : 0")));
  in_disc.disc = Disc{{0.3, 0.3}, 0.2, "/disc"};
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const std::vector<Quantity>& quantities :
         {std::vector(8, pressure_force("bottom", Field(1))), std::vector(2, in_disc)}) {
      Problem problem = block(scheme, 32);
      problem.quantities.clear();
      const double without = seconds(problem), estimated_without = estimate(problem).seconds;
      problem.quantities = quantities;
      const double taken = seconds(problem) - without,
                   foreseen = estimate(problem).seconds - estimated_without;
      EXPECT_LE(taken, 5 * foreseen) << quantities[0].name;
      EXPECT_GE(taken, foreseen / 5) << quantities[0].name;
      const std::vector<Variation> sweep(10, Variation{"", problem.body, problem.boundary, ""});
      // Their fields take half a solve each.
      EXPECT_NEAR(estimate(problem, sweep, {}, {}).problem.seconds, 6 * estimated_without + 11 * foreseen,
                  1e-9);
    }
}

/// What the top takes is what acts from below and the weight; of moments the same.
TEST(QuantityOfABlock, IsInBalanceWithTheOthers) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = block(scheme, 16);
    problem.quantities.push_back(reaction("top", {{0, 1}, 0}));
    problem.quantities.push_back(reaction("top", {{0, 0}, 1}));
    problem.quantities.push_back(pressure_force("bottom", formula("x")));
    const auto all = enclosed(problem);
    for (const EnclosedQuantity& own : all) EXPECT_TRUE(own.guaranteed);
    EXPECT_LE(all[0].lower + all[1].lower, 4);
    EXPECT_GE(all[0].upper + all[1].upper, 4);
    EXPECT_NEAR(all[0].value + all[1].value, 4, 1e-9);
    // The moment of the weight about the origin is 2.
    EXPECT_LE(all[2].lower + all[3].lower, 2);
    EXPECT_GE(all[2].upper + all[3].upper, 2);
    EXPECT_NEAR(all[2].value + all[3].value, 2, 1e-3);
  }
}

/// ℓ(u) = −2 J(u) where nothing is fixed but at 0, and the foundation touches at rest.
TEST(QuantityOfTheLoads, IsTwiceTheEnergy) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  for (auto& [part, condition] : problem.boundary)
    if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = Field(0);
  problem.body = VectorField(formula("4 - 9*x*y"));
  problem.quantities = {mean_in("work", problem.body)};
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  const EnclosedQuantity& work = summary.quantities.at(0);
  EXPECT_TRUE(work.guaranteed);
  EXPECT_LE(work.lower, -2 * summary.error_bound->energy_lower);
  EXPECT_GE(work.upper, -2 * summary.error_bound->energy_upper);
}

/// Its density would be rounding beside the differences by which it is known.
TEST(QuantityInADisc, IsRefusedWhereNothingIsSeenOfIt) {
  Problem problem = block(Scheme::conforming, 4);
  for (const double radius : {0.1, 2e-6, 1e-6, 1e-9, 1e-12}) {
    const std::string square = digits(radius * radius);
    Quantity mean = mean_in("disc", VectorField(Field(0), formula("(x-0.51)^2 + (y-0.52)^2 < " + square +
                                                                  " ? 1 / (pi * " + square + ") : 0")));
    mean.disc = Disc{{0.51, 0.52}, radius, "/disc"};
    problem.quantities = {mean};
    if (radius < 1.4e-6) {
      EXPECT_THROW(solve(problem, {ActiveSet{}, {}}), InvalidProblem) << radius;
    } else {
      const EnclosedQuantity own = enclosed(problem).at(0);
      EXPECT_TRUE(own.guaranteed);
      EXPECT_LE(own.lower, -0.0032) << radius;  // by 64 × 64 squares it is −0.00323
      EXPECT_GE(own.upper, -0.0033) << radius;
    }
  }
}

TEST(QuantityInAPolygon, IsRefusedWhereThatDoesNotLieInTheBody) {
  Problem problem;
  problem.domain =
      Polygon{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{{0.4, 0.4}, {0.6, 0.4}, {0.5, 0.6}}}, {"a", "b", "c", "d"}};
  problem.mesh = MeshRequest(LargestEdge{0.3});
  problem.boundary = {{"a", Fixed{}}};
  const auto is_refused = [&](const std::vector<Point>& corners) {
    Quantity mean = mean_in("mean", VectorField(Field(1)));
    mean.outline = Outline{corners, "/quantities/0/polygon"};
    problem.quantities = {mean};
    try {
      solve(problem, {ActiveSet{}, {}});
    } catch (const InvalidProblem& invalid) {
      EXPECT_EQ(invalid.faults().front().where, "/quantities/0/polygon");
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused({{0.1, 0.1}, {0.3, 0.1}, {0.3, 0.9}, {0.1, 0.9}}));
  EXPECT_FALSE(is_refused({{0, 0}, {1, 0}, {1, 0.3}, {0, 0.3}}));             // along the boundary
  EXPECT_TRUE(is_refused({{0.1, 0.1}, {1.2, 0.1}, {0.3, 0.9}}));              // beyond it
  EXPECT_TRUE(is_refused({{0.2, 0.2}, {0.9, 0.2}, {0.9, 0.9}, {0.2, 0.9}}));  // around the hole
  EXPECT_TRUE(is_refused({{0.45, 0.42}, {0.55, 0.42}, {0.5, 0.5}}));          // in the hole
  EXPECT_TRUE(is_refused({{0.1, 0.1}, {0.3, 0.3}, {0.3, 0.1}, {0.1, 0.3}}));  // twisted
}

TEST(QuantityOfABlock, IsRefusedBeyondDoublePrecision) {
  Problem problem = block(Scheme::conforming, 4);
  problem.quantities = {pressure_force("bottom", Field(1.7e308))};
  EXPECT_THROW(solve(problem, {ActiveSet{}, {}}), SolveError);
}

/// A block that is lowered onto an even foundation is pressed evenly: all spaces contain the solution.
TEST(QuantityOfAPatchTest, IsKnownToRounding) {
  for (const double scale : {1., 1e-9, 1e9}) {
    Problem problem = problems::lowered_block(Scheme::conforming, Pattern::right, 0.3, 0.01, 0.03);
    std::get<YoungPoisson>(problem.material).young = Field(3 * scale);
    problem.quantities = {pressure_force("bottom", Field(1))};
    const EnclosedQuantity force = enclosed(problem).at(0);
    EXPECT_TRUE(force.guaranteed);
    EXPECT_LE(force.relative_width(), 1e-9) << force.lower << " " << force.upper;
    EXPECT_NEAR(force.value / force.estimate, 1, 1e-9);
  }
}

/// Found from outside: rounding was that of a solution of the size of the dual one.
TEST(QuantityOfABodyAtRest, IsKnownExactly) {
  for (const double scale : {1., 1e-9, 1e9}) {
    Problem problem = problems::paper(Scheme::nonconforming, 4);
    problem.material = MembraneStiffness::isotropic(Field(scale));
    problem.body = Field(0);
    problem.boundary = {{"top", Fixed{}}};
    problem.quantities = {mean_on("right", Field(1))};
    const EnclosedQuantity mean = enclosed(problem).at(0);
    EXPECT_TRUE(mean.guaranteed);
    EXPECT_EQ(mean.value, 0);
    EXPECT_LE(mean.upper - mean.lower, 1e-90);
  }
}

/// The nearer end where rounding alone takes the value out of the interval.
TEST(EstimateWithin, IsTheValueButForRounding) {
  EXPECT_EQ(estimate_within(0.3, 0, 1), 0.3);
  EXPECT_EQ(estimate_within(-5e-18, 0, 0.43), 0);
  EXPECT_EQ(estimate_within(1 + 1e-12, 0, 1), 1);
  EXPECT_EQ(estimate_within(-0.1, 0, 1), 0.5);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(estimate_within(-0.1, 0, infinity), 0);
  EXPECT_EQ(estimate_within(2, -infinity, 1), 1);
  EXPECT_EQ(estimate_within(2, 1, infinity), 2);
}

/// The foundation alone deforms the body, so that F = 2 J(u) / δ.
TEST(QuantityOfAnOverlap, IsKnownAsTheEnergyIs) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const int n : {8, 16}) {
      Problem problem = block(scheme, n);
      problem.body = {};
      problem.boundary["bottom"] = Contact{Field(-0.02)};
      const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
      const EnclosedQuantity& force = summary.quantities.at(0);
      EXPECT_TRUE(force.guaranteed);
      EXPECT_LE(force.relative_width(), 1.1 * std::pow(summary.error_bound->relative, 2));
      EXPECT_LE(force.lower, 2 * summary.error_bound->energy_upper / 0.02);
      EXPECT_GE(force.upper, 2 * summary.error_bound->energy_lower / 0.02);
    }
}

/// A body that hangs free above its foundation: what opens is the gap and what it sags by, which is known.
TEST(QuantityOfAnOpening, IsTheGapLessTheDisplacement) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = block(scheme, 8);
    problem.boundary["bottom"] = Contact{formula("0.1 + 0.05*x")};
    problem.quantities = {opening("bottom", formula("2*x"))};
    const EnclosedQuantity open = enclosed(problem).at(0);
    problem.boundary["bottom"] = Traction{};
    problem.quantities = {mean_on("bottom", VectorField(Field(0), formula("2*x")))};
    const EnclosedQuantity sagged = enclosed(problem).at(0);
    const double gap = 0.1 + 0.1 / 3;  // ∫ 2 x g
    EXPECT_TRUE(open.guaranteed);
    EXPECT_NEAR(open.value, gap + sagged.value, 0.01 * gap);
    EXPECT_LE(open.lower, gap + sagged.upper);
    EXPECT_GE(open.upper, gap + sagged.lower);
    EXPECT_LE(open.relative_width(), 0.05);
  }
}

TEST(QuantityOfAnOpening, NeedsABodyThatIsHeldWithoutItsContacts) {
  Problem problem = block(Scheme::conforming, 4);
  problem.boundary = {{"left", Roller{}}, {"bottom", Contact{Field(0)}}};
  problem.quantities = {opening("bottom", Field(1))};
  const EnclosedQuantity open = enclosed(problem).at(0);
  EXPECT_FALSE(open.guaranteed);
  EXPECT_FALSE(open.unmet.empty());
}

/// Where what is weighed touches beside what is fixed, no bound of the energy bounds it.
TEST(QuantityBesideASupport, IsNotClaimed) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  for (auto& [part, condition] : problem.boundary)
    if (std::holds_alternative<Contact>(condition)) {
      std::get<Contact>(condition).gap = Field(0);
      problem.quantities = {pressure_force(part, Field(1))};
    }
  const EnclosedQuantity force = enclosed(problem).at(0);
  EXPECT_FALSE(force.guaranteed);
  ASSERT_FALSE(force.unmet.empty());
  EXPECT_GT(force.value, 0.1);
}

/// Of a weight that changes its sign that is not so: its force is about −0.02.
TEST(QuantityOfAPositiveWeight, IsNowhereNegative) {
  for (const Scheme scheme : {Scheme::nonconforming, Scheme::conforming}) {
    Problem problem = block(scheme, 8);
    const Field hat = formula("max(0, 0.05 - abs(x - 0.3))");
    problem.quantities = {pressure_force("bottom", hat), opening("bottom", hat),
                          pressure_force("bottom", formula("0.3 - x"))};
    const std::vector<EnclosedQuantity> all = enclosed(problem);
    for (const int i : {0, 1}) {
      EXPECT_TRUE(all[i].guaranteed);
      EXPECT_GE(all[i].lower, 0);
      EXPECT_LE(all[i].value, all[i].upper);
    }
    EXPECT_TRUE(all[2].guaranteed);
    EXPECT_LT(all[2].value, 0);
    EXPECT_LT(all[2].lower, all[2].value);
  }
}

/// No point of the mesh knows of it.
TEST(QuantityOfAHat, IsEnclosedWithinAnEdge) {
  for (const Scheme scheme : {Scheme::nonconforming, Scheme::conforming}) {
    Problem problem = block(scheme, 4);
    const EnclosedQuantity whole = enclosed(problem).at(0);
    problem.quantities = {pressure_force("bottom", formula("max(0, 1 - abs(x - 0.56) * 1000)"))};
    const EnclosedQuantity force = enclosed(problem).at(0);
    EXPECT_TRUE(force.guaranteed) << (force.unmet.empty() ? "" : force.unmet.front());
    EXPECT_LE(force.upper, 3 * whole.upper);
  }
}

/// u = −2 y presses with p = 2. Where a kink lies among the halves of an edge, both parts beside it are
/// linear.
TEST(QuantityOfAHat, HasItsPeakAnywhereWithinAnEdge) {
  for (const Scheme scheme : {Scheme::nonconforming, Scheme::conforming})
    for (const int n : {1, 3, 4})
      for (const double peak : {0.5, 0.25, 0.375, 0.0625, 0.3, 127. / 256, 1. / 3}) {
        Problem problem = problems::paper(scheme, n);
        problem.body = VectorField(Field(0));
        for (const char* side : {"left", "right", "top"})
          problem.boundary[side] = Fixed{VectorField(formula("-2*y"))};
        problem.boundary["bottom"] = Contact{Field(0)};
        const std::string at = digits(peak);
        problem.quantities = {
            pressure_force("bottom", formula("min(x / " + at + ", (1 - x) / (1 - " + at + "))")),
            pressure_force("bottom",
                           formula("x < " + at + " ? x / " + at + " : (1 - x) / (1 - " + at + ")"))};
        for (const EnclosedQuantity& force : enclosed(problem)) {
          EXPECT_TRUE(force.guaranteed) << n << ' ' << peak;
          EXPECT_LE(force.lower, 1 + 1e-12) << n << ' ' << peak;
          EXPECT_GE(force.upper, 1 - 1e-12) << n << ' ' << peak;
        }
      }
}

/// Rounding tells what is nothing, and nothing else.
TEST(QuantityOfABody, HasTheSameWidthInAnyUnits) {
  const auto width = [](double unit) {
    Problem problem = problems::paper(Scheme::conforming, 12);
    const std::string in_units = digits(unit) + "*";
    problem.material = MembraneStiffness::isotropic(Field(unit));
    problem.body = VectorField(formula(in_units + "sin(3*x + 1)*-5"));
    problem.boundary["bottom"] = Contact{formula("0.01 + 0.02*(x - 0.4)^2")};
    problem.boundary["top"] = Traction{VectorField(Field(unit * 0.3))};
    problem.quantities = {mean_on("top", VectorField(Field(1)))};
    return enclosed(problem).at(0).relative_width();
  };
  const double one = width(1);
  for (const double unit : {7.67, 2.51e-3, 3.27e2, 1e-9, 1e9})
    EXPECT_NEAR(width(unit), one, 1e-6 * one) << unit;
}

Solution solved(const Problem& problem, const std::vector<Variation>& sweep) {
  Observer indifferent;
  problems::Shelf shelf;
  return solve(problem, sweep, {ActiveSet{}, {}}, indifferent, shelf);
}

/// What entries share with each other changes nothing: each has the intervals of the same problem alone.
TEST(QuantitiesOfASweep, AreThoseOfTheProblemsAlone) {
  for (const Scheme scheme : {Scheme::nonconforming, Scheme::conforming}) {
    Problem problem = block(scheme, 6);
    problem.operator_key = "block";
    Quantity disc = mean_in("disc", VectorField(Field(0), formula("(x-0.5)^2 + (y-0.4)^2 < 0.05 ? 1 : 0")));
    problem.quantities = {pressure_force("bottom", formula("1 + x")), disc, opening("bottom", Field(1)),
                          reaction("top", {Vector(0, 1), 0})};
    const YoungPoisson soft{Field(100), Field(0.2), Plane::strain};
    std::vector<Variation> sweep(5, Variation{"", problem.body, problem.boundary, ""});
    sweep[1].body = VectorField(Field(1), Field(-6));
    sweep[2].boundary["bottom"] = Contact{formula("0.004 + 0.01*x^2")};
    sweep[3].material = std::make_shared<const Material>(soft);
    sweep[3].material_key = "soft";
    const Solution solution = solved(problem, sweep);
    ASSERT_EQ(solution.sweep.size(), sweep.size());
    for (std::size_t i = 0; i < sweep.size(); ++i) {
      Problem alone = problem;
      alone.body = sweep[i].body;
      alone.boundary = sweep[i].boundary;
      if (sweep[i].material) alone.material = *sweep[i].material;
      const std::vector<EnclosedQuantity> expected = enclosed(alone), &found = solution.sweep[i].quantities;
      ASSERT_EQ(found.size(), expected.size()) << solution.sweep[i].error;
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_EQ(found[k].lower, expected[k].lower) << i << " " << found[k].name;
        EXPECT_EQ(found[k].upper, expected[k].upper) << i << " " << found[k].name;
        EXPECT_TRUE(found[k].guaranteed);
      }
    }
  }
}

/// Discs are projected once, and that is foreseen.
TEST(QuantitiesOfASweep, AreForeseenInMemory) {
  if (sanitized) GTEST_SKIP() << "memory is counted without sanitizers";
  for (const std::size_t count : {2, 8}) {
    Problem problem = block(Scheme::conforming, 48);
    problem.quantities.clear();
    for (std::size_t i = 0; i < count; ++i)
      problem.quantities.push_back(mean_in("m" + std::to_string(i), VectorField(Field(0), formula("x*y"))));
    const std::vector<Variation> sweep(3, Variation{"", problem.body, problem.boundary, ""});
    const auto peak = static_cast<double>(solved(problem, sweep).summary.peak_memory_bytes);
    const double foreseen = estimate(problem, sweep, {}, {ActiveSet{}, {}}).problem.memory_bytes;
    EXPECT_LE(peak, foreseen) << count;
    EXPECT_GE(2 * peak, foreseen) << count;
  }
}

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Field random_formula(std::mt19937& random, double mean, double size) {
  return formula(digits(mean) + " + " + digits(between(random, -size, size)) + "*sin(" +
                 digits(between(random, 1, 4)) + "*x + " + digits(between(random, 0, 6)) + ") + " +
                 digits(between(random, -size, size)) + "*y*x");
}

Problem random_membrane(unsigned seed) {
  std::mt19937 random(seed);
  Problem problem;
  problem.scheme = seed % 2 ? Scheme::conforming : Scheme::nonconforming;
  problem.domain = Rectangle{{0, 0}, {between(random, 0.6, 2), between(random, 0.6, 2)}};
  const double width = std::get<Rectangle>(problem.domain).size.x();
  problem.mesh = MeshRequest(Divisions{6, 6}, seed % 3 ? Pattern::right : Pattern::crossed);
  if (seed % 4 == 0) problem.material = MembraneStiffness::isotropic(formula("1 + 0.5*sin(3*x)*y"));
  problem.body = VectorField(random_formula(random, -2, 6));
  if (seed % 5 == 0) problem.body = VectorField(formula("x < 0.31 ? 9 : -7"));
  problem.boundary = {{"top", Fixed{VectorField(random_formula(random, 0, 0.1))}},
                      {"bottom", Contact{random_formula(random, 0.02, 0.05)}},
                      {"right", Traction{VectorField(random_formula(random, 0, 1))}}};
  if (seed % 3 == 0) problem.boundary["left"] = Contact{random_formula(random, 0.3, 0.1)};
  const std::string span = digits(width);
  problem.quantities = {pressure_force("bottom", formula("x * (" + span + " - x)")),
                        pressure_force("bottom", formula("max(0, min(x, " + span + " / 2 - x))")),
                        mean_on("right", VectorField(formula("y"))),
                        mean_in("disc", VectorField(formula("(x-0.3)^2 + (y-0.3)^2 < 0.04 ? 8 : 0"))),
                        opening("bottom", Field(1)),
                        opening("bottom", formula("max(0, 0.3 - abs(x - 0.4))")),
                        reaction("top", {{1, 0}, 0})};
  return problem;
}

Problem random_body(unsigned seed) {
  std::mt19937 random(1000 + seed);
  Problem problem;
  problem.scheme = seed % 2 ? Scheme::conforming : Scheme::nonconforming;
  const double poisson[] = {0, 0.3, 0.45, 0.4999};
  problem.material = YoungPoisson{Field(between(random, 50, 300)), Field(poisson[seed % 4]), Plane::strain};
  if (seed % 3 == 0) {
    problem.domain = Polygon{{{0, 0}, {1.3, 0}, {1.3, 0.9}, {0, 1.1}},
                             {{{0.4, 0.4}, {0.7, 0.4}, {0.6, 0.7}}},
                             {"bottom", "right", "top", "left"}};
    problem.mesh = MeshRequest(LargestEdge{0.25});
  } else {
    problem.mesh = MeshRequest(Divisions{5, 5});
  }
  problem.body = VectorField(random_formula(random, 0, 2), random_formula(random, -6, 3));
  problem.boundary = {{"top", Fixed{VectorField(Field(0), random_formula(random, 0, 0.01))}},
                      {"bottom", Contact{random_formula(random, 0.005, 0.01)}},
                      {"right", Pressure{random_formula(random, 1, 2)}}};
  if (seed % 5 == 0) problem.boundary["left"] = Contact{random_formula(random, 0.005, 0.005), {-1, -0.2}};
  problem.quantities = {
      pressure_force("bottom", formula("1 + x")),
      pressure_force("bottom", formula("max(0, 0.4 - abs(x - 0.5))")),
      mean_on("right", VectorField(Field(1), Field(0))),
      mean_in("disc", VectorField(Field(0), formula("(x-0.2)^2 + (y-0.2)^2 < 0.02 ? 9 : 0"))),
      opening("bottom", Field(1)),
      opening("bottom", formula("x - 0.3")),
      reaction("top", {{0, 1}, 0}),
      reaction("top", {{0, 0}, 1})};
  return problem;
}

/// A body between rollers, which a frictionless foundation holds from below.
Problem random_rolling_body(unsigned seed) {
  std::mt19937 random(2000 + seed);
  Problem problem;
  problem.scheme = seed % 2 ? Scheme::conforming : Scheme::nonconforming;
  problem.material =
      YoungPoisson{Field(between(random, 50, 300)), Field(between(random, 0, 0.45)), Plane::strain};
  problem.domain = Polygon{
      {{0, 0}, {between(random, 0.8, 1.5), 0}, {1, 0.9}, {0, 1.1}}, {}, {"bottom", "right", "top", "left"}};
  problem.mesh = MeshRequest(LargestEdge{0.25});
  problem.body = VectorField(random_formula(random, 0, 2), random_formula(random, -6, 3));
  problem.boundary = {{"left", Roller{}},
                      {"bottom", Contact{random_formula(random, 0.005, 0.01)}},
                      {"top", Pressure{random_formula(random, 1, 2)}}};
  if (seed % 3 == 0) problem.boundary["right"] = Roller{};
  problem.quantities = {reaction("left", {{1, 0}, 0}), reaction("left", {{0, 0}, 1}),
                        reaction("left", {{0.2, 7}, -0.3}), pressure_force("bottom", Field(1))};
  if (seed % 3 == 0) problem.quantities.push_back(reaction("right", {{0.6, 0.2}, 1}));
  return problem;
}

class RandomQuantities : public testing::TestWithParam<unsigned> {};

void expect_enclosed(const EnclosedNumber& own, const EnclosedNumber& better, const std::string& name) {
  EXPECT_LE(own.lower, better.estimate) << name;
  EXPECT_GE(own.upper, better.estimate) << name;
  EXPECT_LE(better.lower, own.upper) << name;
  EXPECT_GE(better.upper, own.lower) << name;
  EXPECT_LE(own.lower, own.estimate) << name;
  EXPECT_GE(own.upper, own.estimate) << name;
}

void expect_enclosed(const Certified& coarse, const Certified& fine) {
  expect_enclosed(coarse.energy, fine.energy, "energy");
  expect_enclosed(coarse.work, fine.work, "work");
  ASSERT_EQ(coarse.supports.size(), fine.supports.size());
  for (std::size_t i = 0; i < coarse.supports.size(); ++i) {
    const CertifiedSupport &own = coarse.supports[i], &better = fine.supports[i];
    for (std::size_t c = 0; c < own.force.size(); ++c)
      expect_enclosed(own.force[c], better.force[c], own.parts[0] + " force");
    if (own.moment) expect_enclosed(*own.moment, *better.moment, own.parts[0] + " moment");
    if (own.pressure_force)
      expect_enclosed(*own.pressure_force, *better.pressure_force, own.parts[0] + " pressure force");
  }
}

/// What is known on sixteen times the triangles lies inside, up to what that does not know itself.
void expect_enclosed(Problem problem) {
  const Summary on_coarse = solve(problem, {ActiveSet{}, {}}).summary;
  problem.mesh.refine += 2;
  const Summary on_fine = solve(problem, {ActiveSet{}, {}}).summary;
  ASSERT_TRUE(on_coarse.certified && on_fine.certified);
  expect_enclosed(*on_coarse.certified, *on_fine.certified);
  const auto &coarse = on_coarse.quantities, &fine = on_fine.quantities;
  ASSERT_EQ(coarse.size(), fine.size());
  const bool touches_beside_support = condition_on<Contact>(problem, "left");
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const EnclosedQuantity &own = coarse[i], &better = fine[i];
    if (!own.guaranteed || !better.guaranteed) {
      // A reaction may be none that the energy bounds, and then says so.
      EXPECT_TRUE(touches_beside_support && !problem.quantities[i].motions.empty()) << own.name;
      const EnclosedQuantity& unclaimed = own.guaranteed ? better : own;
      EXPECT_THAT(unclaimed.unmet, testing::Contains(testing::HasSubstr("beside a support"))) << own.name;
      continue;
    }
    EXPECT_LE(own.lower, better.estimate) << own.name;
    EXPECT_GE(own.upper, better.estimate) << own.name;
    EXPECT_LE(better.lower, own.upper) << own.name;
    EXPECT_GE(better.upper, own.lower) << own.name;
  }
}

/// The pair of a quantity's dual problem beside that of the problem.
class DualPairs {
 public:
  DualPairs(const Problem& problem, double factor)
      : problem_(problem),
        condensed_(problem_, requested_mesh(problem_, progress_), Factorization::multifrontal, progress_),
        fields_(condensed_.find(ActiveSet{}, progress_)),
        solution_(describe(discrete(), condensed_.used_operator()->shared_mesh(), fields_, {ActiveSet{}, {}},
                           progress_)),
        laws_(problem_.material, discrete().mesh, 1e-5, progress_),
        base_(discrete(), solution_, admissible_pair(discrete(), solution_, fields_.coupling, progress_),
              load_remainders(discrete(), progress_), laws_, progress_),
        condensed_dual_(condensed_, problem_.quantities.front(), progress_),
        dual_solution_(condensed_, condensed_dual_),
        dual_(solved(factor).certified(base_, factor, laws_, progress_)) {}

  const Discretization& discrete() const { return condensed_.discretization(); }
  const AdmissiblePair& base() const { return base_.pair; }
  const AdmissiblePair& dual() const { return dual_.pair; }
  double factor() const {
    return std::max(dual().v.factor(), dual().pressure.factor_beside(base().pressure));
  }

 private:
  const DualSolution& solved(double factor) {
    dual_solution_.solve(fields_.clearance, factor, progress_);
    return dual_solution_;
  }

  Observer observer_;
  Progress progress_{observer_, std::nullopt};
  const Problem problem_;
  CondensedProblem condensed_;
  Fields fields_;
  const Solution solution_;
  const LawOnMesh laws_;
  const CertifiedSolution base_;
  CondensedDual condensed_dual_;
  DualSolution dual_solution_;
  const CertifiedSolution dual_;
};

/// A membrane that sags onto a foundation with waves.
Problem sagging_membrane(Scheme scheme, int n) {
  Problem problem = problems::paper(scheme, n);
  problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{formula("1.3 + 0.3 * sin(6 * x)")}}};
  problem.body = VectorField(Field(-3));
  return problem;
}

/// |w − η_n| ≤ K (g − v_n) + b 4 s (1 − s) and |p_τ| ≤ K p* in many points, of contacts that begin somewhere.
void expect_within_bounds(const Problem& problem, double given) {
  const DualPairs pairs(problem, given);
  EXPECT_TRUE(pairs.dual().unmet().empty());
  const double factor = pairs.factor();
  EXPECT_TRUE(std::isfinite(factor));
  const auto &base = pairs.base().pressure, &dual = pairs.dual().pressure;
  double largest = 0, pressure = 0;
  for (const ContactEdge& contact : pairs.discrete().clearance.edges)
    largest = std::max(largest, std::abs(pairs.dual().v.along_contact(contact, 0.5)));
  int closed = 0, open = 0;
  for (std::size_t i = 0; i < base.at_ends.size(); ++i) {
    const ContactEdge& contact = pairs.discrete().clearance.edges[i];
    const double beyond = pairs.dual().v.beyond_base(contact);
    for (int k = 0; k <= 20; ++k) {
      const double s = k / 20., room = pairs.base().v.room(contact, s);
      EXPECT_LE(std::abs(pairs.dual().v.room(contact, s)),
                factor * std::max(0., room) + beyond * 4 * s * (1 - s) + 1e-9 * largest)
          << i << " " << s;
    }
    for (const int k : {0, 1}) {
      EXPECT_LE(std::abs(dual.at_ends[i][k]), factor * base.at_ends[i][k] * (1 + 1e-12));
      pressure = std::max(pressure, std::abs(dual.at_ends[i][k]));
    }
    ++(base.at_ends[i][0] > 1e-9 * base.at_ends[base.at_ends.size() / 2][0] ? closed : open);
  }
  EXPECT_GT(pressure, 0);
  EXPECT_GT(closed, 0);
  EXPECT_GT(open, 0);
}

TEST(DualPairs, StayWithinTheirBoundsWhereContactBegins) {
  for (const Scheme scheme : {Scheme::nonconforming, Scheme::conforming})
    for (const Problem& problem :
         {sagging_membrane(scheme, 12), block(scheme, 12), problems::half_disc(scheme)})
      for (const char* weight : {"1 + x", "max(0, 0.3 - abs(x - 0.41))"})
        for (const double factor : {1e3, 30., 1.}) {
          SCOPED_TRACE(std::string(weight) +
                       (scheme == Scheme::conforming ? " conforming " : " nonconforming ") +
                       std::to_string(factor));
          Problem asked = problem;
          std::string part;
          for (const auto& [name, condition] : problem.boundary)
            if (std::holds_alternative<Contact>(condition)) part = name;
          asked.quantities = {pressure_force(part, formula(weight))};
          expect_within_bounds(asked, factor);
        }
}

/// Where a contact is closed v follows the gap, so that no pressure works on a distance.
TEST(DualPairs, BelongToADisplacementThatFollowsTheGap) {
  Problem problem = block(Scheme::conforming, 12);
  const DualPairs pairs(problem, 100);
  int followed = 0;
  for (const ContactEdge& contact : pairs.discrete().clearance.edges)
    if (pairs.base().v.off_followed_gap(contact)) {
      ++followed;
      EXPECT_NEAR(pairs.base().v.room(contact, 0.5), 0, 1e-12);
    }
  EXPECT_GE(followed, 3);
}

constexpr unsigned kSeeds = 8;

/// The problems of a seed; `tests/run --long` takes so many in all.
void expect_all_enclosed(Problem (*make)(unsigned), unsigned seed, unsigned in_all) {
  for (unsigned own = seed; own < (long_tests() ? in_all : kSeeds); own += kSeeds) {
    SCOPED_TRACE("seed " + std::to_string(own));
    expect_enclosed(make(own));
  }
}

TEST_P(RandomQuantities, OfMembranesAreEnclosed) {
  expect_all_enclosed(random_membrane, GetParam(), 56);
}

TEST_P(RandomQuantities, OfBodiesAreEnclosed) {
  expect_all_enclosed(random_body, GetParam(), 32);
}

TEST_P(RandomQuantities, OfRollingBodiesAreEnclosed) {
  expect_all_enclosed(random_rolling_body, GetParam(), 32);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomQuantities,
                         sanitized ? testing::Range(1u, 2u) : testing::Range(0u, kSeeds));

}  // namespace
}  // namespace signorini::quantity_test
