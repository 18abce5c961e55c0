// Faults of the data, and data that must arrive where it belongs: exact polynomial solutions.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "norms.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"

namespace signorini::data_test {
namespace {

/// u = 1 + 2x − 3y + (x² + xy) / 2 with κ = [2 0.5; 0.5 1]: σ = κ∇u is linear, f constant.
struct Quadratic {
  static constexpr double kappa_xx = 2, kappa_xy = 0.5, kappa_yy = 1;
  static double u(const Point& p) {
    return 1 + 2 * p.x() - 3 * p.y() + 0.5 * (p.x() * p.x() + p.x() * p.y());
  }
  static Vector stress(const Point& p) {
    const Vector gradient(2 + p.x() + 0.5 * p.y(), -3 + 0.5 * p.x());
    return {kappa_xx * gradient.x() + kappa_xy * gradient.y(),
            kappa_xy * gradient.x() + kappa_yy * gradient.y()};
  }
  static constexpr double load = -(kappa_xx * 1 + kappa_xy * 0.5 + kappa_xy * 0.5);

  static Problem problem(Pattern pattern) {
    Problem problem;
    problem.domain = Rectangle{{-0.3, 0.2}, {1.2, 0.8}};
    problem.mesh = {Divisions{4, 3}, pattern};
    problem.scheme = Scheme::conforming;
    problem.material = MembraneStiffness{Field(kappa_xx), Field(kappa_xy), Field(kappa_yy)};
    problem.body = Field(load);
    const Field normal_stress([](const Point& x, const Vector& n) { return stress(x).dot(n); }, "/traction");
    // Closed at the bottom by a gap g = −u; the pressure σ·n = −σ_y must be positive there.
    problem.boundary = {{"left", Fixed{problems::function(u)}},
                        {"right", Traction{normal_stress}},
                        {"top", Traction{normal_stress}},
                        {"bottom", Contact{problems::function([](const Point& x) { return -u(x); })}}};
    return problem;
  }
};

class Patterns : public testing::TestWithParam<Pattern> {};

TEST_P(Patterns, ConformingReproducesALinearStress) {
  Problem problem = Quadratic::problem(GetParam());
  // The gap is the exact trace less 0.1 x, so that the contact stays open; u is then not fixed there but by
  // the pressure 0: use a fixed bottom for the exact solution, and contact for the closed one below.
  problem.boundary["bottom"] = Fixed{problems::function(Quadratic::u)};
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  EXPECT_LT(stress_error(solution, Quadratic::stress), 1e-11);
  EXPECT_NEAR(solution.summary.residuals.constitutive, 0, 1e-13);
}

INSTANTIATE_TEST_SUITE_P(All, Patterns,
                         testing::Values(Pattern::right, Pattern::left, Pattern::alternating,
                                         Pattern::crossed));

TEST(Patch, ClosedContactWithAGapReproducesALinearDisplacement) {
  // u = −g with g = 0.2 + 0.1 x at the bottom; u = −g + y elsewhere: pressure σ·n = −∂u/∂y = −1 would pull,
  // so take u = −g − y, pressure 1, traction −1 at the top, ∓0.1 at the sides.
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem;
    problem.mesh = {Divisions{5, 4}, Pattern::alternating};
    problem.scheme = scheme;
    const auto gap = [](const Point& x) { return 0.2 + 0.1 * x.x(); };
    problem.boundary = {
        {"bottom", Contact{problems::function(gap)}},
        {"top", Traction{-1}},
        {"left", Traction{0.1}},
        {"right", Fixed{problems::function([&](const Point& x) { return -gap(x) - x.y(); })}}};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    EXPECT_LT(stress_error(solution, [](const Point&) { return Vector(-0.1, -1); }), 1e-12);
    for (std::size_t i = 0; i < solution.contact[0].points.size(); ++i) {
      EXPECT_EQ(solution.contact[0].clearance[i], 0);
      // The conforming pressure of the corner shared with the fixed side holds that side's reaction too.
      if (scheme == Scheme::nonconforming) {
        EXPECT_NEAR(solution.contact[0].pressure[i], 1, 1e-12);
      }
    }
    // The primal energy: ½|σ|² − ∫ t u, with u = −g − y.
    const double top = -1 * -(0.25 + 1), left = 0.1 * -(0.2 + 0.5);
    EXPECT_NEAR(solution.summary.energy, 0.5 * 1.01 - top - left, 1e-12);
  }
}

TEST(Patch, OpenContactIsATractionFreeSide) {
  // For P0 traces: the P1 clearance tests only the continuous part of the pressure.
  Problem contact = Quadratic::problem(Pattern::right);
  contact.scheme = Scheme::nonconforming;
  contact.boundary["bottom"] = Contact{100};
  Problem free = contact;
  free.boundary.erase("bottom");
  const Solution a = solve(contact, {ActiveSet{}, {}}), b = solve(free, {ActiveSet{}, {}});
  EXPECT_LT((a.stress - b.stress).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(a.summary.contact.length, 0);
  EXPECT_EQ(b.summary.iterations, 0);
}

TEST(Stress, NormalTracesAreContinuous) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Solution solution = solve(problems::paper(scheme, 8), {ActiveSet{}, {}});
    const Mesh& mesh = *solution.mesh;
    const RaviartThomas& element = spaces_of(scheme, 1).row;
    for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
      if (mesh.edge_triangles[edge][1] < 0) continue;
      const Point x = mesh.points[mesh.edges[edge][0]] * 0.3 + mesh.points[mesh.edges[edge][1]] * 0.7;
      const Vector normal = mesh.outward_normal(edge);
      double jump = 0;
      for (const int side : {0, 1}) {
        const int t = mesh.edge_triangles[edge][side];
        const AffineMap map(mesh.corners(t));
        const Point reference = map.jacobian.inverse() * (x - map.origin);
        jump += (side ? 1 : -1) * normal.dot(element.values(map, reference) * solution.stress.col(t));
      }
      EXPECT_NEAR(jump, 0, 1e-11);
    }
  }
}

std::vector<Fault> faults_of(const Problem& problem) {
  try {
    solve(problem, {ActiveSet{}, {}});
  } catch (const InvalidProblem& invalid) {
    return invalid.faults();
  }
  return {};
}

TEST(Faults, AreNamedWithTheirPlace) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  problem.body = problems::function([](const Point& x) { return 1 / (x.x() < 0.9 ? 1. : 0.); }, "/load/body");
  auto faults = faults_of(problem);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "/load/body");
  EXPECT_NE(faults[0].detail.find("not finite at (0.9"), std::string::npos) << faults[0].detail;

  problem = problems::paper(Scheme::conforming, 8);
  problem.material = MembraneStiffness{Field(1), Field(1), Field(1)};
  faults = faults_of(problem);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "/material/stiffness");

  problem = problems::paper(Scheme::conforming, 8);
  problem.boundary["nowhere"] = Fixed{};
  problem.domain = Rectangle{{0, 0}, {0, 1}};
  EXPECT_EQ(faults_of(problem)[0].where, "/domain/size");
  problem.domain = Rectangle{};
  EXPECT_EQ(faults_of(problem)[0].where, "/boundary/nowhere");

  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    problem = problems::paper(scheme, 8);
    problem.boundary["bottom"] = Contact{Field(-0.1, "/boundary/bottom/gap")};
    faults = faults_of(problem);
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].where, "/boundary/bottom/gap");
    EXPECT_NE(faults[0].detail.find("can never be met"), std::string::npos);
  }
}

TEST(Estimates, CountLikeTheSolution) {
  for (unsigned seed = 1; seed < (sanitized ? 5 : 30); ++seed) {
    const Problem problem = problems::random(seed);
    const Estimate predicted = estimate(problem);
    const Summary summary = solve(problem, {ActiveSet{}, {}}).summary;
    EXPECT_EQ(predicted.triangles, summary.triangles);
    EXPECT_EQ(predicted.unknowns.stress, summary.unknowns.stress);
    EXPECT_EQ(predicted.unknowns.displacement, summary.unknowns.displacement);
    EXPECT_EQ(predicted.unknowns.contact, summary.unknowns.contact) << seed;
  }
}

TEST(Meshes, LargestEdgeIsKept) {
  for (const Pattern pattern : {Pattern::right, Pattern::left, Pattern::alternating, Pattern::crossed})
    for (const double size : {0.5, 0.1, 0.033}) {
      Problem problem = problems::paper(Scheme::nonconforming, 1);
      problem.mesh = {LargestEdge{size}, pattern};
      const Mesh mesh = *solve(problem, {ActiveSet{}, {}}).mesh;
      double longest = 0;
      for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge)
        longest = std::max(longest, mesh.length(edge));
      EXPECT_LE(longest, size * (1 + 1e-12));
      EXPECT_GT(longest, 0.6 * size);
      EXPECT_NEAR(mesh.area(), 1, 1e-13);
    }
}

}  // namespace
}  // namespace signorini::data_test
