// What `converged` promises: the residuals that are recomputed from the fields are met.
#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"
#include "solve.hpp"

namespace signorini::converged_test {
namespace {

double largest_contact_residual(const Residuals& left) {
  return std::max({left.penetration, left.tension, left.complementarity});
}

/// Rounding of what S does not know.
constexpr double kSame = 1 + 1e-4, kRounding = 1e-12;

void expect_met(const Problem& problem, const std::string& which) {
  for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
    const Summary summary = solve(problem, {Mprgp{tolerance}, {}}).summary;
    EXPECT_EQ(summary.outcome, Outcome::converged) << which << ", " << tolerance;
    EXPECT_LE(largest_contact_residual(summary.residuals), kSame * tolerance + kRounding)
        << which << ", " << tolerance;
  }
  const Summary exact = solve(problem, {ActiveSet{}, {}}).summary;
  EXPECT_EQ(exact.outcome, Outcome::converged) << which;
  EXPECT_LE(largest_contact_residual(exact.residuals), kRounding) << which;
}

/// A block that is held at its left side and pulled to the right, away from what is below it, over gaps that
/// it never closes; `unit` scales lengths.
Problem free_block(Scheme scheme, double gap, double unit) {
  Problem problem = problems::block(scheme, Pattern::right, 3, 0.3);
  problem.domain = Rectangle{{0, 0}, {2 * unit, unit}};
  problem.boundary = {{"left", Fixed{VectorField(0, 0)}},
                      {"bottom", Contact{gap * unit}},
                      {"right", Traction{VectorField(0.3, 0.02)}}};
  return problem;
}

TEST(Converged, MeansThatTheResidualsAreMetWhereNothingTouches) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double gap : {1., 10., 100.})
      for (const double unit : {1e-9, 1., 1e9})
        expect_met(free_block(scheme, gap, unit),
                   "gap " + std::to_string(gap) + ", unit " + std::to_string(unit));
}

/// S has lost digits of the pressures; with the stress they are found again.
TEST(Converged, MeansThatTheResidualsAreMetWhereTheBodyIsNearlyIncompressible) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double poisson : {0.4999, 0.49999, 0.499999}) {
      Problem problem = problems::block(scheme, Pattern::right, 1, poisson);
      problem.domain = Polygon{{{0, 0}, {1.5, 0}, {1.5, 0.6}, {0.7, 0.6}, {0.7, 1.2}, {0, 1.2}},
                               {},
                               {"bottom", "right", "ledge", "inner", "top", "left"}};
      problem.mesh = MeshRequest(LargestEdge{sanitized ? 0.25 : 0.07});
      problem.body = VectorField(Field(0), problems::formula("-0.03 + 0.03 * tanh(20 * (x - 0.26))"));
      problem.boundary = {{"top", Fixed{VectorField(0, 0)}},
                          {"left", Traction{VectorField(0.06, 0)}},
                          {"bottom", Contact{problems::formula("0.07 - 0.03 * x")}}};
      expect_met(problem, "ν = " + std::to_string(poisson));
    }
}

TEST(Converged, MeansThatTheResidualsAreMetWhereContactIsTinyBesideTheLoad) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double push : {1e-3, 1e-6, 1e-9}) {
      Problem problem = problems::block(scheme, Pattern::right, 3, 0.3);
      problem.boundary = {{"left", Fixed{VectorField(0, 0)}},
                          {"right", Contact{problems::function([&](const Point&) { return -push; })}},
                          {"top", Traction{VectorField(0, 0.1)}},
                          {"bottom", Traction{VectorField(0, -0.1)}}};
      expect_met(problem, "push " + std::to_string(push));
    }
}

/// Pulled along as it is, over a gap that is much larger than the displacement: all stress is rounding.
TEST(Converged, IsWhatMovesWithoutStress) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double length : {1e-9, 1., 1e9})
      for (const double displacement : {1e-9, 1., 1e9})
        for (const Method& method : {Method(Mprgp{}), Method(ActiveSet{})}) {
          Problem problem;
          problem.domain = Rectangle{{0, 0}, {length, length}};
          problem.mesh.fineness = Divisions{6, 5};
          problem.scheme = scheme;
          problem.boundary = {{"bottom", Fixed{0.00833 * displacement}},
                              {"left", Contact{0.2043 * displacement}}};
          const Summary summary = solve(problem, {method, {}}).summary;
          EXPECT_EQ(summary.outcome, Outcome::converged) << summary.advice;
          for (const std::string& note : summary.notes)
            EXPECT_EQ(note.find("worth nothing"), std::string::npos) << note;
          problem.mesh.adaptive = Adaptive{0.1, 1000};
          const Summary refined = solve(problem, {method, {}}).summary;
          EXPECT_EQ(refined.outcome, Outcome::converged) << refined.advice;
          EXPECT_EQ(refined.levels.size(), 1u);
        }
}

/// The pressures of finer meshes have more rounding, which iterating on still mends.
TEST(Converged, IsWhatMovesWithoutStressOnFineMeshes) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Divisions& divisions : {Divisions{10, 14}, Divisions{40, 56}, Divisions{100, 10}}) {
      if (sanitized && divisions.x > 20) continue;
      Problem problem = problems::paper(scheme, 5);
      problem.mesh.fineness = divisions;
      problem.body = {};
      problem.boundary = {{"left", Fixed{0.7}}, {"bottom", Contact{1}}};
      const Summary summary = solve(problem, {Mprgp{}, {}}).summary;
      EXPECT_EQ(summary.outcome, Outcome::converged) << summary.advice;
    }
}

/// The body rests, because the mesh sees nothing of a ridge that reaches through it.
TEST(Converged, IsABodyAtRestUnderARidgeThatTheMeshDoesNotSee) {
  Problem problem = problems::paper(Scheme::nonconforming, 5);
  problem.mesh.fineness = Divisions{7, 5};
  problem.body = {};
  problem.boundary = {{"left", Fixed{}},
                      {"right", Fixed{}},
                      {"bottom", Contact{problems::formula("0.1 - 0.3*exp(-1e4*(x-0.4123)^2)")}}};
  for (const Method& method : {Method(Mprgp{}), Method(ActiveSet{})}) {
    const Summary summary = solve(problem, {method, {}}).summary;
    EXPECT_EQ(summary.outcome, Outcome::converged) << summary.advice;
    EXPECT_GT(summary.error_bound->energy_upper, 0);
    EXPECT_LT(std::abs(summary.energy), 1e-20 * summary.error_bound->energy_upper);
    EXPECT_TRUE(std::ranges::any_of(summary.notes, [](const std::string& note) {
      return note.find("worth nothing") != std::string::npos;
    }));
  }
}

/// Its equilibrium cannot be told from rounding by its stress, which is nothing but that.
TEST(Converged, IsAnElasticBodyAtRestUnderARidgeThatTheMeshDoesNotSee) {
  Problem problem = problems::block(Scheme::nonconforming, Pattern::right, 1, 0.3);
  problem.domain = Rectangle{{0, 0}, {1, 1}};
  problem.mesh.fineness = Divisions{2, 2};
  problem.boundary = {{"left", Contact{problems::formula("0.1-0.2*exp(-2000*(y-0.4)^2)")}},
                      {"bottom", Fixed{VectorField(0, 0)}},
                      {"top", Roller{}}};
  const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
  EXPECT_TRUE(summary.error_bound->guaranteed);
  EXPECT_LE(summary.residuals.equilibrium, 1e-9);
  EXPECT_GT(summary.error_bound->energy_upper, 0.01);
}

TEST(Converged, MeansThatTheResidualsAreMetOnRandomProblems) {
  for (unsigned seed = 1; seed < (sanitized ? 2 : 21); ++seed)
    expect_met(problems::random(seed), "seed " + std::to_string(seed));
}

/// The first step with a tiny rho hardly moves the displacement, which is all that the paper's criterion
/// sees.
TEST(Stalled, IsThePapersFormWithStepsThatGetNowhere) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const auto& [rho, augmentation] :
         {std::pair(1e-6, 1.), std::pair(1e-3, 100.), std::pair(1e-6, 1e6), std::pair(1., 1e6)})
      for (const double modulus : {1e-9, 1., 1e9}) {
        Problem problem = problems::paper(scheme, 12);
        problem.material = MembraneStiffness::isotropic(Field(modulus));
        problem.body = problems::function([=](const Point& x) { return (x.x() < 0.5 ? 10 : -10) * modulus; });
        const Solution solution =
            solve(problem, {PaperUzawa{rho / modulus, augmentation / modulus, 1, 1e-5, 1000}, {}});
        EXPECT_EQ(solution.summary.outcome, Outcome::stalled) << rho << ' ' << augmentation << ' ' << modulus;
        EXPECT_NE(solution.summary.advice.find("rho"), std::string::npos);
        EXPECT_TRUE(solution.stress.allFinite());
        EXPECT_FALSE(solution.history.empty());
      }
}

TEST(Stalled, IsNotThePapersFormThatGetsThere) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double tolerance : {1e-2, 1e-3, 1e-5, 1e-8, 1e-14}) {
      const PaperUzawa method{scheme == Scheme::conforming ? 0.05 : 0.1, 1, 1, tolerance, 100000};
      EXPECT_EQ(solve(problems::paper(scheme, 12), {method, {}}).summary.outcome, Outcome::converged)
          << tolerance;
    }
}

}  // namespace
}  // namespace signorini::converged_test
