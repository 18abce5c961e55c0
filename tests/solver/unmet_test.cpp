// Every reason for which a bound is not guaranteed is said, in both models.

#include <gtest/gtest.h>

#include "certify/certificate.hpp"
#include "certify/data/carried_loads.hpp"
#include "certify/elasticity/edge_tractions.hpp"
#include "certify/shape_norms.hpp"
#include "no_pressure.hpp"
#include "problems/elasticity.hpp"
#include "solved_problem.hpp"

namespace signorini::unmet_test {
namespace {

Problem membrane() {
  Problem problem = problems::paper(Scheme::conforming, 2);
  problem.body = VectorField(-1);
  problem.boundary["top"] = Traction{VectorField(-1)};
  return problem;
}

Problem block() {
  Problem problem;
  problem.mesh = {Divisions{2, 2}, Pattern::crossed};
  problem.material = YoungPoisson{Field(2), Field(0.3), Plane::strain};
  problem.body = VectorField(0, -1);
  problem.boundary = {
      {"left", Fixed{}}, {"bottom", Contact{Field(0.01)}}, {"top", Traction{VectorField(0, -0.1)}}};
  return problem;
}

std::vector<std::string> unmet(const Problem& problem) {
  return solve(problem, {ActiveSet{}, {}}).summary.error_bound.value().unmet;
}

/// What is known in points only.
const Field kOne = problems::function([](const Point&) { return 1.; }, "/by/points");

void expect_named(const Problem& problem) {
  const std::vector<std::string> reasons = unmet(problem);
  ASSERT_EQ(reasons.size(), 1u);
  EXPECT_NE(reasons[0].find("/by/points"), std::string::npos) << reasons[0];
}

TEST(Unmet, IsALoadATractionAGapAFixedValueOrALawThatIsKnownInPointsOnly) {
  for (const Problem& sound : {membrane(), block()}) {
    EXPECT_EQ(unmet(sound), std::vector<std::string>());
    const bool is_body = sound.body.size() == 2;
    const VectorField by_points = is_body ? VectorField(kOne, kOne) : VectorField(kOne);
    Problem problem = sound;
    problem.body = by_points;
    expect_named(problem);
    problem = sound;
    problem.boundary["top"] = Traction{by_points};
    expect_named(problem);
    problem = sound;
    problem.boundary["bottom"] = Contact{kOne};
    expect_named(problem);
    problem = sound;
    problem.boundary["left"] = Fixed{by_points};
    expect_named(problem);
    problem = sound;
    problem.material = is_body ? Material(YoungPoisson{kOne, Field(0.3), Plane::strain})
                               : Material(MembraneStiffness::isotropic(kOne));
    expect_named(problem);
  }
}

/// The residual of equilibrium that rounding may leave is 1e-9.
TEST(Unmet, IsAStressThatIsNotInEquilibrium) {
  for (const Problem& problem : {membrane(), block()})
    for (const double residual : {0.9e-9, 1.1e-9}) {
      SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
      made.solution.summary.residuals.equilibrium = residual;
      const Eigen::VectorXd coupling = Eigen::VectorXd::Zero(made.discretization.traces.unknowns());
      ShapeNorms norms;
      const ErrorBound bound =
          certify(made.discretization, made.solution, coupling, norms, made.progress).bound;
      ASSERT_EQ(bound.unmet.size(), residual > 1e-9 ? 1u : 0u);
      EXPECT_EQ(bound.guaranteed, bound.unmet.empty());
      if (!bound.guaranteed) {
        EXPECT_NE(bound.unmet[0].find("the stress is not in equilibrium"), std::string::npos);
      }
    }
}

/// A body that contact alone holds, where p* cannot take what is not known of the load; less of it p* can
/// take, and the contact term grows with it.
TEST(Unmet, IsALoadOfWhichTheContactCannotTakeWhatIsNotKnown) {
  Problem problem = membrane();
  problem.scheme = Scheme::nonconforming;
  problem.boundary = {{"bottom", Contact{problems::formula("0.1*x^2")}}, {"top", Contact{Field(0)}}};
  problem.body = VectorField(problems::formula("-10 + 10*sin(1e7*x*(y + 1.3))"));
  const std::vector<std::string> reasons = unmet(problem);
  ASSERT_EQ(reasons.size(), 1u);
  EXPECT_NE(reasons[0].find("and no fixed part takes the rest"), std::string::npos) << reasons[0];
}

/// What it can take makes p* larger, and the contact term with it.
TEST(Guaranteed, IsTheContactTermOfAPressureThatTakesWhatIsNotKnown) {
  Problem problem = membrane();
  problem.scheme = Scheme::nonconforming;
  problem.boundary = {{"bottom", Contact{problems::formula("0.1*x^2")}}, {"top", Contact{Field(0)}}};
  problem.body = VectorField(-10);
  const ErrorBound plain = solve(problem, {ActiveSet{}, {}}).summary.error_bound.value();
  problem.body = VectorField(problems::formula("-10 + 0.2*sin(1e7*x*(y + 1.3))"));
  const SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
  const ErrorBound bound = made.solution.summary.error_bound.value();
  EXPECT_TRUE(bound.guaranteed);
  const LawOnMesh laws(problem.material, *made.solution.mesh, 1e-8, made.progress);
  const double change = carry_uncertain_loads(made.discretization, laws,
                                              {made.discretization, made.solution.stress, made.clearance})
                            .change_of_pressure;
  EXPECT_GT(change, 0.2);
  const double square = std::pow(plain.parts.contact, 2);
  EXPECT_NEAR(std::pow(bound.parts.contact, 2), (1 + change) * square, 0.1 * change * square);
}

/// A peak of the foundation that the mesh does not see leaves nothing but rounding.
TEST(Unmet, OfAMembraneAtRestIsNotItsLaw) {
  Problem problem;
  problem.domain = Polygon{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}, {"bottom", "right", "top", "left"}};
  problem.mesh.fineness = LargestEdge{0.1};
  for (const double radius : {3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1})
    problem.mesh.sizes.push_back({{0.31234, 0}, radius, radius / 6});
  problem.material = MembraneStiffness::isotropic(Field(1));
  problem.boundary = {{"top", Fixed{}},
                      {"bottom", Contact{problems::formula("1 - 1.1*max(0, 1 - 1e4*abs(x - 0.31234))")}}};
  problem.scheme = Scheme::nonconforming;
  const std::vector<std::string> reasons = unmet(problem);
  ASSERT_FALSE(reasons.empty());
  EXPECT_EQ(reasons[0].find("law"), std::string::npos) << reasons[0];
  EXPECT_NE(reasons[0].find("hardly any stress"), std::string::npos) << reasons[0];
}

/// Two triangles that have a corner in common, and no more: around it no way meets both.
TEST(Unmet, IsABodyThatTouchesItselfInAPoint) {
  Problem problem = block();
  problem.boundary = {{"ground", Fixed{}}};
  const Mesh mesh = make_mesh({Point(0, 0), Point(1, 0), Point(0, 1), Point(-1, 0), Point(0, -1)},
                              {{0, 1, 2}, {0, 3, 4}}, {"ground"}, {{{0, 1}, 0}, {{0, 3}, 0}});
  const Discretization discretization(problem, mesh);
  Observer nobody;
  Progress progress(nobody, std::nullopt);
  const EdgeTractions tractions(discretization, no_stress(discretization), no_pressure(discretization),
                                progress);
  ASSERT_EQ(tractions.unmet().size(), 1u);
  EXPECT_NE(tractions.unmet()[0].find("the body touches itself in the point"), std::string::npos);
}

}  // namespace
}  // namespace signorini::unmet_test
