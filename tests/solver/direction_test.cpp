// Contact along a direction of its own instead of the normal of each edge.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "problems/elasticity.hpp"

namespace signorini::direction_test {
namespace {

constexpr std::array kSchemes{Scheme::conforming, Scheme::nonconforming};

/// A body on a roller at its left side, with a floor that falls to the right; turned by an angle and scaled.
struct Slanted {
  double angle = 0, length = 1, modulus = 1;

  Vector turned(const Vector& v) const { return Eigen::Rotation2Dd(angle) * v; }
  Point back(const Point& x) const { return Eigen::Rotation2Dd(-angle) * x / length; }

  /// The gap is a function of the point before turning and scaling.
  Problem problem(Scheme scheme, const Vector& direction,
                  const std::function<double(const Point&)>& gap) const {
    Problem problem = problems::block(scheme, Pattern::right, 3 * modulus, 0.3);
    MeshData mesh{{{0, 0}, {2, -0.5}, {2, 1}, {0, 1}, {0.9, 0.4}},
                  {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
                  {{"floor", {{0, 1}}}, {"right", {{1, 2}}}, {"top", {{2, 3}}}, {"left", {{3, 0}}}}};
    for (Point& point : mesh.points) point = length * turned(point);
    problem.domain = mesh;
    problem.mesh = {};
    problem.mesh.refine = 3;
    const Slanted self = *this;
    const Vector pull = 0.7 * modulus * turned({0, -1});
    problem.boundary = {
        {"left", Roller{}},
        {"floor", Contact{problems::function([=](const Point& x) { return self.length * gap(self.back(x)); }),
                          turned(direction)}},
        {"top", Traction{VectorField(pull.x(), pull.y())}}};
    return problem;
  }
};

double falling_away(const Point& x) {
  return 0.4 * x.x() * x.x();
}

TEST(Direction, TheNormalIsTheDefault) {
  for (const Scheme scheme : kSchemes) {
    const Solution plain = solve(Slanted{}.problem(scheme, Vector::Zero(), falling_away), {ActiveSet{}, {}});
    const Solution along =
        solve(Slanted{}.problem(scheme, Vector(-0.5, -2), falling_away), {ActiveSet{}, {}});
    ASSERT_GT(plain.summary.contact.force, 0.1);
    ASSERT_LT(plain.summary.contact.length, 2);
    EXPECT_LT((along.stress - plain.stress).cwiseAbs().maxCoeff(), 1e-12);
  }
}

/// σ = (0, −p, 0) and u = p (1 + ν)/E (ν x, −(1 − ν) y): with a vertical reaction that is the solution on a
/// slanted floor, whose distance is what u needs. The pressure is a force per length of the floor.
TEST(Direction, AVerticalReactionCarriesAUniformPressure) {
  for (const Scheme scheme : kSchemes) {
    const auto gap = [](const Point& x) { return 0.7 * (1 - 0.3 * 0.3) / 3 * x.y(); };
    const Solution solution = solve(Slanted{}.problem(scheme, Vector(0, -5), gap), {ActiveSet{}, {}});
    for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
      ASSERT_LT((solution.stress_at_centroids.col(t) - Eigen::Vector3d(0, -0.7, 0)).norm(), 1e-11) << t;
    for (const double pressure : solution.contact[0].pressure)
      EXPECT_NEAR(pressure, 0.7 * 2 / std::hypot(2, 0.5), 1e-11);
    EXPECT_NEAR(solution.summary.contact.force, 1.4, 1e-11);
  }
}

TEST(Direction, TheReactionActsAlongIt) {
  for (const Scheme scheme : kSchemes) {
    const Vector direction = Vector(0.6, -0.8);
    const Solution solution = solve(Slanted{}.problem(scheme, direction, falling_away), {ActiveSet{}, {}});
    for (const Reaction& part : solution.summary.parts) {
      if (part.part != "floor") continue;
      EXPECT_NEAR(part.force[0], -0.6 * solution.summary.contact.force, 1e-11);
      EXPECT_NEAR(part.force[1], 0.8 * solution.summary.contact.force, 1e-11);
    }
    EXPECT_GT(solution.summary.contact.force, 0.1);
    EXPECT_LT(solution.summary.residuals.constitutive, 1e-11);
    EXPECT_LT(solution.summary.residuals.equilibrium, 1e-11);
  }
}

TEST(Direction, ATurnedAndScaledBodyIsTheSameBody) {
  const Vector direction(0.2, -1);
  for (const Scheme scheme : kSchemes) {
    const Solution straight = solve(Slanted{}.problem(scheme, direction, falling_away), {ActiveSet{}, {}});
    for (const Slanted& changed : {Slanted{0.5}, Slanted{0, 1e9, 1e-9}, Slanted{2, 1e-9, 1e9}}) {
      const Solution same = solve(changed.problem(scheme, direction, falling_away), {ActiveSet{}, {}});
      EXPECT_EQ(same.summary.iterations, straight.summary.iterations);
      ASSERT_EQ(same.contact[0].open, straight.contact[0].open);
      for (std::size_t i = 0; i < straight.contact[0].points.size(); ++i) {
        EXPECT_NEAR(same.contact[0].pressure[i] / changed.modulus, straight.contact[0].pressure[i], 1e-10);
        EXPECT_NEAR(same.contact[0].clearance[i] / changed.length, straight.contact[0].clearance[i], 1e-10);
      }
    }
  }
}

TEST(Direction, TheMethodsAgree) {
  for (const Scheme scheme : kSchemes) {
    const Problem problem = Slanted{}.problem(scheme, Vector(0.2, -1), falling_away);
    const Solution exact = solve(problem, {ActiveSet{}, {}});
    const Solution uzawa = solve(problem, {Mprgp{1e-12, 100000}, {}});
    EXPECT_LT((uzawa.stress - exact.stress).cwiseAbs().maxCoeff(), 1e-8);
  }
}

/// Of a foundation that no edge's normal is the normal of; the fine energy lies between the bounds of the
/// coarse.
TEST(Direction, TheErrorIsBounded) {
  Problem problem = Slanted{}.problem(Scheme::conforming, Vector(0.2, -1), falling_away);
  std::get<Contact>(problem.boundary.at("floor")).gap = problems::formula("0.4 * x^2");
  const ErrorBound coarse = *solve(problem, {ActiveSet{}, {}}).summary.error_bound;
  problem.mesh.refine = 5;
  const double energy = solve(problem, {ActiveSet{}, {}}).summary.energy;
  EXPECT_TRUE(coarse.guaranteed);
  EXPECT_LT(coarse.relative, 0.25);
  EXPECT_LE(coarse.energy_lower, energy);
  EXPECT_GE(coarse.energy_upper, energy);
}

void expect_fault(const Problem& problem) {
  const std::vector<Fault> faults = validate(problem);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "/boundary/floor/direction");
}

TEST(Direction, MustPointOutOfTheBody) {
  for (const Vector& direction : {Vector(0, 1), Vector(2, -0.5)})
    expect_fault(Slanted{}.problem(Scheme::conforming, direction, falling_away));
  Problem membrane = problems::paper(Scheme::nonconforming, 4);
  membrane.boundary["bottom"] = Contact{0, Vector(0, -1)};
  EXPECT_EQ(validate(membrane).at(0).where, "/boundary/bottom/direction");
}

}  // namespace
}  // namespace signorini::direction_test
