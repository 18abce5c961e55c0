// A membrane or a body without a fixed part: contact alone holds it, or nothing does.
#include <gtest/gtest.h>

#include "problems/membrane.hpp"

namespace signorini::held_by_contact_test {
namespace {

Problem resting(Scheme scheme, double load, double gap) {
  Problem problem;
  problem.mesh.fineness = Divisions{12, 9};
  problem.scheme = scheme;
  problem.body = problems::function([=](const Point& x) { return load * (1 + 0.8 * std::sin(5 * x.x())); });
  problem.boundary = {{"bottom", Contact{gap}}, {"top", Contact{gap}}};
  return problem;
}

double total_load(const Problem& problem) {
  // ∫ 1 + 0.8 sin 5x over the unit square.
  return problem.body(0, {0, 0}) * (1 + 0.8 * (1 - std::cos(5.)) / 5);
}

TEST(HeldByContactAlone, TheForceIsTheWholeLoad) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{1e-12, 100000}}}) {
      const Problem problem = resting(scheme, -3, 0.2);
      const Solution solution = solve(problem, {method, {}});
      ASSERT_EQ(solution.summary.outcome, Outcome::converged);
      EXPECT_NEAR(solution.summary.contact.force, -total_load(problem), 1e-5);
      EXPECT_LT(solution.summary.residuals.equilibrium, 1e-11);
      EXPECT_LT(solution.summary.residuals.tension, 1e-11);
    }
}

TEST(HeldByContactAlone, AUniformGapIsATranslation) {
  const Solution low = solve(resting(Scheme::conforming, -3, 0.2), {ActiveSet{}, {}});
  const Solution high = solve(resting(Scheme::conforming, -3, 0), {ActiveSet{}, {}});
  // u ≥ −g: the wider gap lets the membrane sink by 0.2.
  EXPECT_NEAR((high.displacement - low.displacement).minCoeff(), 0.2, 1e-11);
  EXPECT_NEAR((high.displacement - low.displacement).maxCoeff(), 0.2, 1e-11);
}

TEST(HeldByContactAlone, UniformLoadOnOneSideIsKnown) {
  // −u'' = −1 across the strip, u = −g at the bottom, u' = 0 at the top: u = −g − y + y²/2, pressure 1.
  Problem problem = resting(Scheme::conforming, 0, 0);
  problem.body = Field(-1);
  problem.boundary = {{"bottom", Contact{0.1}}};
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  for (std::size_t i = 0; i < solution.contact[0].points.size(); ++i)
    EXPECT_NEAR(solution.contact[0].pressure[i], 1, 1e-11);
  for (int t = 0; t < solution.displacement.cols(); ++t) {
    const Point centroid =
        (solution.mesh->corners(t)[0] + solution.mesh->corners(t)[1] + solution.mesh->corners(t)[2]) / 3;
    EXPECT_NEAR(solution.stress_at_centroids(1, t), -1 + centroid.y(), 1e-10);
  }
}

void expect_diagnosis(const Problem& problem, const std::string& word) {
  for (const Method& method :
       {Method{ActiveSet{}}, Method{Mprgp{}}, Method{PaperUzawa{0.1, 1, 0, 1e-5, 100}}})
    try {
      solve(problem, {method, {}});
      ADD_FAILURE() << "solved what nothing holds";
    } catch (const SolveError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
}

TEST(NothingHolds, ALiftingLoadIsDiagnosed) {
  expect_diagnosis(resting(Scheme::conforming, 3, 0.2), "lifts it off");
}
TEST(NothingHolds, NoLoadIsDiagnosed) {
  expect_diagnosis(resting(Scheme::nonconforming, 0, 0.2), "no work at all");
}

TEST(NothingHolds, ADiscThatMayTurnInItsHoleIsDiagnosed) {
  Polygon disc{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}, {}, {"rim", "rim", "rim", "rim"}};
  for (int i = 0; i < 4; ++i) disc.arcs.push_back({0, i, {0, 0}});
  Problem problem;
  problem.domain = disc;
  problem.mesh.fineness = LargestEdge{0.5};
  problem.scheme = Scheme::nonconforming;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  problem.body = VectorField(0.01, -0.02);
  problem.boundary = {{"rim", Contact{0.001}}};
  expect_diagnosis(problem, "middles of its edges");
  // The corners of the polygon that stands for the disc hold it.
  problem.scheme = Scheme::conforming;
  EXPECT_EQ(solve(problem).summary.outcome, Outcome::converged);
}

TEST(NothingHolds, FreeEverywhereIsAFault) {
  Problem problem = resting(Scheme::conforming, -3, 0);
  problem.boundary = {{"bottom", Traction{1}}};
  try {
    solve(problem);
    FAIL();
  } catch (const InvalidProblem& invalid) {
    ASSERT_EQ(invalid.faults().size(), 1u);
    EXPECT_EQ(invalid.faults()[0].where, "/boundary");
  }
}

}  // namespace
}  // namespace signorini::held_by_contact_test
