// Which bodies come to rest on contact alone, and which do not.
#include <gtest/gtest.h>

#include "problems/elasticity.hpp"

namespace signorini::rest_test {
namespace {

using Boundary = std::map<std::string, Condition>;

/// A block of the given side and modulus; gaps are in units of the side, loads in units of the modulus.
struct Case {
  const char* name;
  Boundary boundary;
  VectorField body;
  const char* motion = "";  ///< that the refusal names; empty if the block rests
};

Contact contact(double gap, Vector direction = Vector::Zero()) {
  return {Field(gap), direction};
}

std::vector<Case> cases() {
  const VectorField nothing, down(Field(0), Field(-0.01)), up(Field(0), Field(0.01)),
      right(Field(0.01), Field(0));
  return {
      {"squeezed from two sides",
       {{"left", Roller{}}, {"bottom", contact(0)}, {"top", contact(-0.02)}},
       nothing},
      {"squeezed and pulled down",
       {{"left", Roller{}}, {"bottom", contact(0)}, {"top", contact(-0.02)}},
       down},
      {"squeezed and pulled up", {{"left", Roller{}}, {"bottom", contact(0)}, {"top", contact(-0.02)}}, up},
      {"touched from two sides", {{"left", Roller{}}, {"bottom", contact(0)}, {"top", contact(0)}}, nothing},
      {"between two gaps, pressed",
       {{"left", Roller{}}, {"bottom", contact(0.1)}, {"top", contact(0.1)}},
       down},
      {"clamped from four sides",
       {{"left", contact(-0.01)}, {"right", contact(0)}, {"bottom", contact(0)}, {"top", contact(-0.01)}},
       nothing},
      {"gaps that overlap together",
       {{"left", Roller{}}, {"bottom", contact(0.1)}, {"top", contact(-0.11)}},
       nothing},
      {"pressed into a corner",
       {{"left", contact(0)}, {"bottom", contact(0)}},
       VectorField(Field(-0.01), Field(-0.01))},
      {"resting", {{"left", Roller{}}, {"bottom", contact(0)}}, down},

      {"between two gaps",
       {{"left", Roller{}}, {"bottom", contact(0.1)}, {"top", contact(0.1)}},
       nothing,
       "floats between its contacts"},
      {"between two gaps that close by less than they open",
       {{"left", Roller{}}, {"bottom", contact(0.1)}, {"top", contact(-0.09)}},
       nothing,
       "floats"},
      {"resting on one side",
       {{"left", Roller{}}, {"bottom", contact(0)}},
       nothing,
       "translation along (0, 1)"},
      {"overlap on one side",
       {{"left", Roller{}}, {"bottom", contact(-0.1)}},
       nothing,
       "translation along (0, 1)"},
      {"lifted", {{"left", Roller{}}, {"bottom", contact(0)}}, up, "translation along (0, 1)"},
      {"squeezed, but free to slide",
       {{"bottom", contact(0)}, {"top", contact(-0.02)}},
       nothing,
       "translation along (1, 0)"},
      {"in a corner without a load",
       {{"left", contact(0)}, {"bottom", contact(0)}},
       nothing,
       "no work at all"},
      {"in a corner, pulled along one side",
       {{"left", contact(0)}, {"bottom", contact(0)}},
       right,
       "translation along (1, 0)"},
      {"in a corner, pressed on one side only",
       {{"left", contact(0)}, {"bottom", contact(0)}},
       down,
       "no work at all"},
  };
}

Problem block(const Case& given, Scheme scheme, double side, double modulus) {
  Problem problem;
  problem.domain = Rectangle{{0, 0}, {side, side}};
  problem.mesh = {Divisions{4, 4}, Pattern::crossed};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(modulus), Field(0.3), Plane::strain};
  problem.boundary = given.boundary;
  for (auto& [part, condition] : problem.boundary)
    if (auto* own = std::get_if<Contact>(&condition)) own->gap = Field(side * own->gap({0, 0}));
  if (given.body.size() == 2)
    problem.body = VectorField(Field(modulus / side * given.body(0, {0, 0})),
                               Field(modulus / side * given.body(1, {0, 0})));
  return problem;
}

std::string refusal(const Problem& problem, const Method& method) {
  try {
    const Solution solution = solve(problem, {method, {}});
    EXPECT_EQ(solution.summary.outcome, Outcome::converged);
    EXPECT_LT(solution.summary.residuals.equilibrium, 1e-9);
    return "";
  } catch (const SolveError& refused) {
    return refused.what();
  }
}

TEST(Rest, WhatContactHoldsIsSolvedAndTheRestNamed) {
  for (const Case& given : cases())
    for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
      for (const double side : {1., 1e-9, 1e9})
        for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{}}}) {
          const std::string found = refusal(block(given, scheme, side, 200 / side), method);
          if (std::string(given.motion).empty())
            EXPECT_EQ(found, "") << given.name;
          else
            EXPECT_NE(found.find(given.motion), std::string::npos) << given.name << ": " << found;
        }
}

TEST(Rest, ASqueezedBlockHasTheForceOfItsOverlap) {
  // Between a floor and a top pushed in by 0.02, free at the right side: σ_yy = −0.02 E / (1 − ν²).
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Solution solution = solve(block(cases()[0], scheme, 1, 200), {ActiveSet{}, {}});
    EXPECT_NEAR(solution.summary.contact.force, 2 * 0.02 * 200 / (1 - 0.09), 1e-9);
    EXPECT_NEAR(solution.summary.energy, 0.5 * 0.02 * 0.02 * 200 / (1 - 0.09), 1e-9);
  }
}

TEST(Rest, NothingHappensBetweenTwoSidesThatTouch) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Solution solution = solve(block(cases()[3], scheme, 1, 200));
    EXPECT_EQ(solution.summary.contact.force, 0);
    EXPECT_EQ(solution.displacement.lpNorm<Eigen::Infinity>(), 0);
  }
}

TEST(Rest, ASmallBodyBesideALargeOneIsHeldAllTheSame) {
  // Two squares, one a millionth of the other; both are fixed below.
  constexpr double e = 1e-6;
  Problem problem;
  problem.domain =
      MeshData{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2 + e, 0}, {2 + e, e}, {2, e}},
               {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}},
               {{"floor", {{0, 1}, {4, 5}}}, {"rest", {{1, 2}, {2, 3}, {3, 0}, {5, 6}, {6, 7}, {7, 4}}}}};
  problem.mesh.refine = 1;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  problem.body = VectorField(Field(0.1), Field(-1));
  problem.boundary = {{"floor", Fixed{}}};
  EXPECT_EQ(refusal(problem, ActiveSet{}), "");
}

}  // namespace
}  // namespace signorini::rest_test
