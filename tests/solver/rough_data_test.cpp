// The bound where data are not smooth: along sides, at points, or nowhere.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fem/traction_field.hpp"
#include "mesh/rectangle.hpp"
#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"

namespace signorini::rough_data_test {
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

/// x², x and x as doubles have them where large numbers cancel; the energies are those of the plain text.
TEST(RoughData, WhatRoundingTakesFromALoadIsInTheBound) {
  const auto holds = [](const std::string& load, const std::string& plain) {
    Problem problem = square();
    problem.mesh.fineness = Divisions{16, 16};
    problem.body = problems::formula(plain);
    const ErrorBound given = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
    problem.body = problems::formula(load);
    const ErrorBound bound = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
    EXPECT_TRUE(bound.guaranteed) << load;
    EXPECT_LE(bound.energy_lower, given.energy_upper) << load;
    EXPECT_GE(bound.energy_upper, given.energy_lower) << load;
  };
  holds("(1-cos(1e-8*x))*2e16", "x^2");
  holds("(1e6+x)^2-1e12-2e6*x", "x^2");
  holds("(x+1e16)-1e16", "x");
  holds("(x+1e12)-1e12", "x");
}

TEST(RoughData, WhatRoundingTakesFromATractionIsInTheBound) {
  Problem problem = square();
  problem.boundary["top"] = Traction{problems::formula("x")};
  const ErrorBound given = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
  problem.boundary["top"] = Traction{problems::formula("(x+1e15)-1e15")};
  const ErrorBound bound = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
  EXPECT_TRUE(bound.guaranteed);
  EXPECT_LE(bound.energy_lower, given.energy_lower);
  EXPECT_GE(bound.energy_upper, given.energy_upper);
}

/// In doubles it is 0, in truth x², of which the norm and the integral on the side are 1/√5 and 1/3.
TEST(RoughData, WhatRoundingTakesFromATractionCountsWithItsNorm) {
  Problem problem = square();
  problem.boundary["top"] = Traction{problems::formula("2e16*(1-cos(1e-8*x))")};
  const Mesh mesh = rectangle_mesh(Rectangle{}, {1, 1}, Pattern::right);
  const TractionField traction(problem, mesh);
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (!traction.acts_on(edge)) continue;
    EXPECT_GE(traction[edge].rest, 1 / std::sqrt(5.));
    EXPECT_GE(traction[edge].uncertain_force, 1. / 3);
    EXPECT_GE(traction[edge].uncertain_work, 1. / 3);
  }
}

TEST(RoughData, GapsFixedValuesAndLawsThatLoseTheirDigitsAreNamed) {
  const auto unmet = [](const std::function<void(Problem&)>& change) {
    Problem problem = square();
    problem.body = Field(-1);
    change(problem);
    const ErrorBound bound = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
    return bound.unmet.empty() ? std::string() : bound.unmet.front();
  };
  const std::string text = "1+((0.1*x+1e15)-1e15)";
  const auto is_named = [&](const std::function<void(Problem&)>& change) {
    return unmet(change).find("so large that rounding leaves it too few digits") != std::string::npos;
  };
  EXPECT_TRUE(is_named([&](Problem& p) { p.boundary["bottom"] = Contact{problems::formula(text)}; }));
  EXPECT_TRUE(is_named([&](Problem& p) { p.boundary["left"] = Fixed{problems::formula(text)}; }));
  EXPECT_TRUE(
      is_named([&](Problem& p) { p.material = MembraneStiffness::isotropic(problems::formula(text)); }));
  EXPECT_EQ(unmet([](Problem& p) { p.boundary["bottom"] = Contact{problems::formula("1+0.1*x")}; }), "");
}

TEST(RoughData, AGapThatFallsFromASupportLikeARootIsMet) {
  Problem problem = square();
  problem.body = Field(-1);
  problem.boundary = {
      {"left", Fixed{}}, {"right", Fixed{}}, {"bottom", Contact{problems::formula("sqrt(x)")}}};
  EXPECT_LE(relative_bound(problem), 0.45);
}

/// It is admissible to stay below it, and still not known what the pressure does on it.
TEST(RoughData, AGapThatRisesWithoutBoundWhereABodyPressesHasNoBound) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const int n : {1, 2}) {
      Problem problem = square();
      problem.scheme = scheme;
      problem.mesh.fineness = Divisions{n, n};
      problem.body = Field(-5);
      problem.boundary = {{"top", Fixed{}},
                          {"bottom", Contact{problems::formula("-0.1*log(abs(x-0.3711))")}}};
      const Solution solution = solve(problem, {ActiveSet{}, {}});
      EXPECT_FALSE(solution.summary.error_bound) << n;
      EXPECT_THAT(solution.summary.notes,
                  testing::Contains(testing::HasSubstr("is not known to be finite near")));
    }
}

/// A root is finite where its slope is not.
TEST(RoughData, AGapWithACuspIsEnclosed) {
  const auto bound = [](int n) {
    Problem problem = square();
    problem.mesh.fineness = Divisions{n, n};
    problem.body = Field(-5);
    problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{problems::formula("0.1*sqrt(abs(x-0.3711))")}}};
    return *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
  };
  const ErrorBound fine = bound(64);
  for (const int n : {1, 2, 8}) {
    const ErrorBound coarse = bound(n);
    EXPECT_TRUE(coarse.guaranteed);
    EXPECT_LE(coarse.energy_lower, fine.energy_upper) << n;
    EXPECT_GE(coarse.energy_upper, fine.energy_lower) << n;
  }
}

/// A corner of triangles is infinite, or would be but for the rounding of what it is computed from.
TEST(RoughData, ALoadWithAPoleHasNoBoundWhereverRoundingPutsIt) {
  struct Case {
    std::string load;
    Rectangle domain;
    int n;
    Pattern pattern;
  };
  for (const auto& [load, domain, n, pattern] :
       {Case{"((x-1)^2+(y-0.75)^2)^-2.5", {{0, 0}, {1, 1}}, 8, Pattern::right},
        Case{"(abs(x-1.5388888888888888)+abs(y-1.0333333333333334))^-4",
             {{-0.35, 0.2}, {2, 1}},
             9,
             Pattern::crossed},
        Case{"1/sqrt((x-0.4)^2+(y-0.45)^2)^2", {{-0.35, 0.2}, {2, 1}}, 12, Pattern::right},
        Case{"sqrt((x-0.65)^2+2*(y-0.9)^2)^-5", {{-0.35, 0.2}, {1.1, 0.7}}, 9, Pattern::crossed},
        Case{"((x-0.4)^2)^-1.5", {{0.1, -0.7}, {0.3, 0.9}}, 4, Pattern::left}}) {
    Problem problem = square();
    problem.domain = domain;
    problem.mesh = MeshRequest(Divisions{n, n}, pattern);
    problem.body = problems::formula(load);
    const ErrorBound bound = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
    EXPECT_FALSE(bound.guaranteed) << load << ": " << bound.value;
    EXPECT_THAT(bound.unmet, testing::ElementsAre(testing::HasSubstr("is not known to be finite near")))
        << load;
  }
}

/// A polynomial that follows it would rise above the rest of the body by many powers of ten.
TEST(RoughData, AGapWithManyWavesOnAnEdgeIsStayedBelow) {
  for (const char* gap : {"0.08+0.01*sin(3333*x)", "0.1+0.08*tanh(500*(x-0.41))"}) {
    Problem problem = square();
    problem.mesh.fineness = Divisions{5, 5};
    problem.scheme = Scheme::nonconforming;
    problem.body = Field(-3);
    problem.boundary["bottom"] = Contact{problems::formula(gap)};
    EXPECT_LE(relative_bound(problem), 0.3) << gap;
  }
}

/// What is linear and nearest to such a modulus is negative in some corners, and no measure of energy.
TEST(RoughData, AModulusThatJumpsInTrianglesIsBoundedOnEveryMesh) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const int refine : {0, 1, 2}) {
      Problem body = problems::pressed_angle(scheme);
      body.mesh.fineness = LargestEdge{0.3876};
      body.mesh.refine = refine;
      body.material = YoungPoisson{problems::formula("x<0.6934?1:18"), Field(0.3), Plane::strain};
      body.body = VectorField(0.3, 0.1);
      body.boundary = {{"bottom", Contact{}}, {"right", Fixed{VectorField(0, 0)}}};
      EXPECT_LE(relative_bound(body), 1.2) << refine;
      Problem membrane = square();
      membrane.mesh.refine = refine;
      membrane.scheme = scheme;
      membrane.body = Field(-1);
      membrane.material = MembraneStiffness::isotropic(problems::formula("x<0.6934?1:100"));
      EXPECT_LE(relative_bound(membrane), 1.2) << refine;
    }
}

TEST(RoughData, AMeshRefinesItselfForALoadWithoutSlopes) {
  Problem problem = square();
  problem.body = problems::formula("sqrt(x*(1-x))");
  problem.mesh.adaptive = Adaptive{0.01, 2000};
  EXPECT_LE(relative_bound(problem), 0.01);
}

}  // namespace
}  // namespace signorini::rough_data_test
