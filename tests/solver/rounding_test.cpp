// What rounding leaves is paid for: bodies that nothing but rounding keeps from being solved exactly.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "problems/elasticity.hpp"
#include "solve.hpp"

namespace signorini::rounding_test {
namespace {

/// Between rollers at both sides, pressed on a foundation: σ_yy = −p, u_y = −p y / E' with the constrained
/// modulus E'.
struct Column {
  double height, poisson, p = 0.125;

  Problem problem(Scheme scheme, Pattern pattern) const {
    Problem made;
    made.domain = Rectangle{{0, 0}, {1, height}};
    made.mesh = {Divisions{2, 4}, pattern};
    made.scheme = scheme;
    made.material = YoungPoisson{Field(1), Field(poisson), Plane::strain};
    made.boundary = {
        {"left", Roller{}}, {"right", Roller{}}, {"bottom", Contact{Field(0)}}, {"top", Pressure{Field(p)}}};
    Quantity top;
    top.name = "top";
    top.densities = {{"top", VectorField(Field(0), Field(1))}};
    made.quantities = {top};
    return made;
  }

  /// More digits than doubles have.
  long double sinking() const {
    const long double nu = poisson;
    return p * (1 + nu) * (1 - 2 * nu) / (1 - nu) * height;
  }
  long double energy() const { return -sinking() * p / 2; }
};

/// Whether there was anything to be enclosed: where rounding leaves too little, no bound is claimed.
bool expect_enclosed(const Column& column, Scheme scheme, Pattern pattern) {
  Summary summary;
  try {
    summary = solve(column.problem(scheme, pattern), {ActiveSet{}, std::nullopt}).summary;
  } catch (const std::runtime_error&) {
    return false;  // rounding leaves nothing of the matrix, and says so
  }
  if (!summary.error_bound || !summary.error_bound->guaranteed) {
    EXPECT_TRUE(summary.error_bound);
    return false;
  }
  EXPECT_LE(summary.error_bound->energy_lower, column.energy());
  EXPECT_GE(summary.error_bound->energy_upper, column.energy());
  const long double work = 2 * -column.energy();
  EXPECT_LE(summary.certified->work.lower, work);
  EXPECT_GE(summary.certified->work.upper, work);
  EXPECT_EQ(summary.quantities.size(), 1u);
  for (const EnclosedQuantity& top : summary.quantities) {
    if (!top.guaranteed) continue;
    EXPECT_LE(top.lower, -column.sinking());
    EXPECT_GE(top.upper, -column.sinking());
  }
  return true;
}

/// Near incompressible the volume is a difference of entries of C; of flat triangles gradients are
/// differences of values that are much alike.
TEST(Rounding, IsPaidForByTheBound) {
  int enclosed = 0;
  for (const double poisson : {-0.9, 0.25, 0.4375, 0.4999, 0.499999, 0.4999999})
    for (const double height : {1., std::exp2(-5), std::exp2(-10)})
      for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
        for (const Pattern pattern : {Pattern::right, Pattern::alternating, Pattern::crossed}) {
          SCOPED_TRACE("ν = " + std::to_string(poisson) + ", height " + std::to_string(height) + ", scheme " +
                       std::to_string(static_cast<int>(scheme)) + ", pattern " +
                       std::to_string(static_cast<int>(pattern)));
          enclosed += expect_enclosed({height, poisson}, scheme, pattern);
        }
  EXPECT_GE(enclosed, 80) << "of 108";
}

/// Of an ordinary body it takes no digit that anybody would miss.
TEST(Rounding, IsLittleOfOrdinaryBodies) {
  const Summary summary =
      solve(Column{1, 0.3}.problem(Scheme::conforming, Pattern::right), {ActiveSet{}, std::nullopt}).summary;
  EXPECT_TRUE(summary.error_bound->guaranteed);
  EXPECT_LE(summary.error_bound->relative, 1e-11);
  EXPECT_LE(summary.quantities[0].upper - summary.quantities[0].lower, 1e-11);
}

/// The bound of a body at rest is 0, and a law that varies is as near to a polynomial as that asks.
TEST(Rounding, OfABodyAtRestEndsToo) {
  Problem problem = problems::block(Scheme::nonconforming, Pattern::right, 1, 0.3);
  problem.material = YoungPoisson{problems::formula("1 + x"), Field(0.3), Plane::strain};
  problem.boundary = {{"right", Fixed{}}, {"top", Contact{Field(0.1)}}};
  Quantity mean;
  mean.name = "mean";
  mean.density = VectorField(Field(0), Field(1));
  problem.quantities = {mean};
  const Summary summary = solve(problem, {ActiveSet{}, 60}).summary;
  ASSERT_EQ(summary.quantities.size(), 1u);
  EXPECT_LE(summary.quantities[0].lower, 0);
  EXPECT_GE(summary.quantities[0].upper, 0);
  EXPECT_LE(summary.quantities[0].upper - summary.quantities[0].lower, 1e-10);
}

/// Without a load nothing moves, and the energy is 0. Iterates whose stress goes down to nothing leave σ* as
/// what rounding leaves of σ_h, which is 1e14 times as large.
TEST(Rounding, OfAStressThatCancelsIsThatOfItsParts) {
  for (const char* stiffness : {"1", "(x+0.5*y<0.437?1:1)", "(x+0.5*y<0.437?1:5)"})
    for (const int divisions : {6, 9})
      for (int iterations = 2; iterations < 7; ++iterations) {
        Problem rest;
        rest.domain = Rectangle{{0, 0}, {1, divisions == 6 ? 0.05 : 0.3}};
        rest.mesh = {Divisions{divisions, 1}, Pattern::right};
        rest.scheme = Scheme::conforming;
        rest.material = MembraneStiffness::isotropic(problems::formula(stiffness));
        rest.boundary = {
            {"left", Fixed{}}, {"right", Fixed{}}, {"bottom", Fixed{}}, {"top", Contact{Field(0.3)}}};
        Settings settings;
        settings.method = Mprgp{};
        std::get<Mprgp>(settings.method).max_iterations = iterations;
        const Solution solution = solve(rest, settings);
        ASSERT_TRUE(solution.summary.error_bound);
        if (!solution.summary.error_bound->guaranteed) continue;
        EXPECT_LE(solution.summary.error_bound->energy_lower, 0) << stiffness << ' ' << iterations;
        EXPECT_GE(solution.summary.error_bound->energy_upper, 0) << stiffness << ' ' << iterations;
      }
}

}  // namespace
}  // namespace signorini::rounding_test
