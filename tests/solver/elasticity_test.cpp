// Elasticity: patch tests to rounding, and orders of convergence.
#include <gtest/gtest.h>

#include "methods_agree.hpp"
#include "norms.hpp"
#include "problems/elasticity.hpp"
#include "problems/sanitized.hpp"

namespace signorini::elasticity_test {
namespace {

struct PatchCase {
  Scheme scheme;
  Pattern pattern;
  double poisson;
};

class Patch : public testing::TestWithParam<PatchCase> {};

constexpr double rounding = 1e-11;

void expect_uniform_stress(const Solution& solution, const Eigen::Vector3d& stress, double scale,
                           double tolerance) {
  for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
    ASSERT_LT((solution.stress_at_centroids.col(t) - stress).norm(), tolerance * scale) << t;
  if (stress.isZero()) return;  // residuals are relative to the stress
  EXPECT_LT(solution.summary.residuals.symmetry, tolerance);
  EXPECT_LT(solution.summary.residuals.equilibrium, tolerance);
}

TEST_P(Patch, PressedOnAFoundation) {
  const auto [scheme, pattern, poisson] = GetParam();
  const double p = 0.7;
  for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{1e-13, 10000}}}) {
    const Solution solution = solve(problems::pressed_block(scheme, pattern, poisson, p), {method, {}});
    ASSERT_EQ(solution.summary.outcome, Outcome::converged);
    expect_uniform_stress(solution, {0, -p, 0}, p, rounding);
    for (std::size_t i = 0; i < solution.contact[0].points.size(); ++i)
      EXPECT_NEAR(solution.contact[0].pressure[i], p, p * rounding);
    EXPECT_NEAR(solution.summary.contact.force, 2 * p, 2 * p * rounding);
  }
}

TEST_P(Patch, OpenUntilTheGapIsUsedUp) {
  const auto [scheme, pattern, poisson] = GetParam();
  const double gap = 0.02, modulus = problems::constrained_modulus(3, poisson);
  const Solution open =
      solve(problems::lowered_block(scheme, pattern, poisson, gap, 0.015), {ActiveSet{}, {}});
  expect_uniform_stress(open, {0, 0, 0}, 0.01 * modulus, rounding);
  for (const double clearance : open.contact[0].clearance) EXPECT_NEAR(clearance, 0.005, 1e-12);
  const Solution closed =
      solve(problems::lowered_block(scheme, pattern, poisson, gap, 0.03), {ActiveSet{}, {}});
  const double p = 0.01 * modulus;
  expect_uniform_stress(closed, {-p * poisson / (1 - poisson), -p, 0}, p, rounding);
  EXPECT_NEAR(closed.summary.contact.force / (2 * p), 1, rounding);
}

std::vector<PatchCase> cases() {
  std::vector<PatchCase> all;
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Pattern pattern : {Pattern::right, Pattern::alternating, Pattern::crossed})
      for (const double poisson : {0.3, 0.4999, 0.499999}) all.push_back({scheme, pattern, poisson});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Cases, Patch, testing::ValuesIn(cases()));

Eigen::Matrix2d stress_at(const Solution& solution, int t, const AffineMap& map, const Point& reference) {
  const RaviartThomas& row = spaces_of(solution.scheme, 2).row;
  return (row.values(map, reference) * solution.stress.col(t).reshaped(2, row.size()).transpose())
      .transpose();
}

double relative_stress_error(Scheme scheme, double poisson, int n, double* rotation = nullptr) {
  const problems::Smooth smooth(poisson);
  const Solution solution = solve(smooth.problem(scheme, n), {ActiveSet{}, {}});
  const double error = integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
    return (stress_at(solution, t, map, x) - smooth.stress(map(x))).squaredNorm();
  });
  const double norm = integrate(solution, [&](int, const AffineMap& map, const Point& x) {
    return smooth.stress(map(x)).squaredNorm();
  });
  if (rotation)
    *rotation = std::sqrt(integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
      const LocalVector hats = triangle_basis(1, x);
      double value = 0;
      for (int z = 0; z < 3; ++z) value += hats[z] * solution.rotation[solution.mesh->triangles[t][z]];
      return std::pow(value - smooth.rotation(map(x)), 2);
    }));
  return std::sqrt(error / norm);
}

void expect_rates(Scheme scheme, double at_least) {
  std::vector<double> last;
  for (const double poisson : {0.3, 0.49999}) {
    std::vector<double> errors, rotations;
    for (const int n : {4, 8, 16, 32}) {
      double rotation = 0;
      errors.push_back(relative_stress_error(scheme, poisson, n, &rotation));
      rotations.push_back(rotation);
    }
    std::printf("nu %.5f: stress %.3e rate %.3f, rotation rate %.3f\n", poisson, errors.back(), rate(errors),
                rate(rotations));
    EXPECT_GE(rate(errors), at_least) << poisson;
    EXPECT_GE(rate(rotations), at_least) << poisson;
    last.push_back(errors.back());
  }
  EXPECT_LT(last[1] / last[0], 2);
}

TEST(Manufactured, NonconformingRates) {
  expect_rates(Scheme::nonconforming, 0.95);
}
TEST(Manufactured, ConformingRates) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  expect_rates(Scheme::conforming, 1.9);
}

/// A random block, fixed at its left side over a wavy gap that begins at 0 there, bent down or up.
Problem random_block(unsigned seed) {
  std::mt19937 engine(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(engine);
  };
  Problem problem = problems::block(seed % 2 ? Scheme::conforming : Scheme::nonconforming,
                                    static_cast<Pattern>(seed % 4), number(1, 5), number(0, 0.49));
  problem.mesh.fineness = Divisions{8 + static_cast<int>(seed % 5), 6};
  const double bend = number(-0.05, 0.05), load = number(-0.4, 0.1), wave = number(2, 7);
  problem.body = VectorField(Field(number(-0.1, 0.1)), Field(number(-0.3, 0.1)));
  const auto gap = [=](const Point& x) { return std::max(bend * std::sin(wave * x.x()), -0.02 * x.x()); };
  const auto pull = [=](const Point& x) { return load * x.x(); };
  problem.boundary = {{"left", Fixed{}},
                      {"bottom", Contact{problems::function(gap)}},
                      {"top", Traction{VectorField(Field(0), problems::function(pull))}}};
  if (seed % 3 == 0) problem.boundary["right"] = Contact{0.01};
  return problem;
}

class RandomBlocks : public testing::TestWithParam<unsigned> {};

TEST_P(RandomBlocks, MethodsAgree) {
  expect_methods_agree(random_block(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBlocks, testing::Range(1u, sanitized ? 5u : 21u));

TEST(PaperForm, ItsFixedPointIsTheActiveSetSolutionOfAnElasticBlock) {
  const Problem problem = problems::pressed_block(Scheme::nonconforming, Pattern::alternating, 0.3, 0.7);
  const Solution uzawa = solve(problem, {PaperUzawa{0.1, 1, 0, 1e-13, 200000}, {}});
  ASSERT_EQ(uzawa.summary.outcome, Outcome::converged);
  for (Eigen::Index t = 0; t < uzawa.stress_at_centroids.cols(); ++t)
    EXPECT_LT((uzawa.stress_at_centroids.col(t) - Eigen::Vector3d(0, -0.7, 0)).norm(), 1e-7);
}

TEST(Tensor, IsotropicEntriesAreYoungAndPoisson) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = random_block(4);
    problem.scheme = scheme;
    problem.material = YoungPoisson{Field(3), Field(0.3), Plane::strain};
    problem.boundary["bottom"] = Contact{};
    const Solution isotropic = solve(problem, {ActiveSet{}, {}});
    const double mu = 3 / 2.6, lambda = 3 * 0.3 / (1.3 * 0.4);
    problem.material = HookeTensor{
        {Field(lambda + 2 * mu), Field(lambda), Field(0), Field(lambda + 2 * mu), Field(0), Field(mu)}};
    const Solution tensor = solve(problem, {ActiveSet{}, {}});
    EXPECT_LT((tensor.stress - isotropic.stress).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Tensor, ATurnedMaterialUnderUniaxialStressStrainsAsItsComplianceSays) {
  // Free sides, pressed on a foundation between rollers: σ = (0, −p, 0), ε = C σ, whatever the axes.
  for (const double angle : {0., 0.3, 1.1}) {
    Problem problem = problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, 0.7);
    problem.material = problems::orthotropic(angle);
    problem.boundary["left"] = Traction{};
    problem.boundary["bottom"] = Fixed{};
    // Fixed below to the linear displacement with that strain.
    const auto compliance = compliance_at(problem.material, {0, 0});
    const Eigen::Vector4d strain = compliance * Eigen::Vector4d(0, 0, 0, -0.7);
    problem.boundary["bottom"] =
        Fixed{VectorField(problems::function([=](const Point& x) { return strain[0] * x.x(); }),
                          problems::function([=](const Point& x) { return 2 * strain[1] * x.x(); }))};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
      ASSERT_LT((solution.stress_at_centroids.col(t) - Eigen::Vector3d(0, -0.7, 0)).norm(), 1e-11);
  }
}

TEST(Graded, AModulusThatVariesInLayersIsResolvedByTheMesh) {
  // Pressed between rollers: σ_yy = −p in every layer, ε_xx = 0; the top sinks by p Σ h_i / E'_i.
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = problems::block(scheme, Pattern::right, 1, 0.3);
    problem.mesh.fineness = Divisions{4, 8};
    problem.material = YoungPoisson{
        problems::function([](const Point& x) { return std::pow(1e4, std::floor(4 * x.y()) / 3); }),
        Field(0.3)};
    problem.boundary = {{"left", Roller{}},
                        {"right", Roller{}},
                        {"bottom", Contact{}},
                        {"top", Traction{VectorField(0, -0.7)}}};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    double sunk = 0;
    for (int layer = 0; layer < 4; ++layer)
      sunk += 0.7 * 0.25 / problems::constrained_modulus(std::pow(1e4, layer / 3.), 0.3);
    // The energy is that of the load: J = −½ ∫ p u.
    EXPECT_NEAR(solution.summary.energy / (-0.5 * 0.7 * 2 * sunk), 1, 1e-10);
    for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
      ASSERT_NEAR(solution.stress_at_centroids(1, t), -0.7, 1e-9);
  }
}

/// A body on rollers, pressed on a foundation that falls away, with a modulus that grows from 1 to 1e4 across
/// it.
Problem graded_block(Scheme scheme, const std::function<double(const Point&)>& young) {
  Problem problem = problems::block(scheme, Pattern::crossed, 1, 0.3);
  problem.mesh.fineness = Divisions{48, 24};
  problem.material = YoungPoisson{problems::function(young), Field(0.3)};
  const auto gap = [](const Point& x) { return 0.001 * x.x() * x.x(); };
  problem.boundary = {{"left", Roller{}},
                      {"bottom", Contact{problems::function(gap)}},
                      {"top", Traction{VectorField(0, -0.01)}}};
  return problem;
}

double slanted_modulus(const Point& x) {
  return std::pow(1e4, (x.x() / 2 + x.y()) / 2);
}

TEST(Graded, ASmoothModulusIsTheLimitOfLayers) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Summary smooth = solve(graded_block(scheme, slanted_modulus), {ActiveSet{}, {}}).summary;
    ASSERT_LT(smooth.contact.length, 1.9);  // part of the foundation is clear
    std::vector<double> energies;
    for (const double layers : {6, 12, 24}) {
      // The modulus at the middle of each square of a grid whose lines are lines of the mesh.
      const auto layered = [=](const Point& x) {
        const auto middle = [=](double s) { return (std::floor(s * layers) + 0.5) / layers; };
        return slanted_modulus({middle(x.x()), middle(x.y())});
      };
      const Summary found = solve(graded_block(scheme, layered), {ActiveSet{}, {}}).summary;
      energies.push_back(std::abs(found.energy / smooth.energy - 1));
    }
    std::printf("smooth against layers: energy %.2e %.2e %.2e\n", energies[0], energies[1], energies[2]);
    EXPECT_LT(energies.back(), 5e-4);
    // Second order, for the middle of a cell is its mean; until the mesh's own error shows.
    EXPECT_GE(rate(energies), scheme == Scheme::conforming ? 1.8 : 1.2);
  }
}

void expect_refused(const Problem& problem, const std::string& motion) {
  try {
    solve(problem, {ActiveSet{}, {}});
    ADD_FAILURE() << "solved what nothing holds";
  } catch (const SolveError& error) {
    EXPECT_NE(std::string(error.what()).find(motion), std::string::npos) << error.what();
  }
}

TEST(FreeMotions, AreNamed) {
  Problem sliding = problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, 0.7);
  sliding.boundary.erase("left");
  expect_refused(sliding, "translation along (1, 0)");

  Problem lifted = problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, -0.7);
  expect_refused(lifted, "translation along (0, 1)");

  // Pressed on one end only beyond the support: it tips about the edge of the contact.
  Problem tipping = problems::block(Scheme::conforming, Pattern::right, 3, 0.3);
  tipping.boundary = {{"left", Traction{}}, {"bottom", Roller{}}};
  expect_refused(tipping, "translation along (1, 0)");
}

/// Two unit squares beside each other; the second has conditions of its own.
Problem two_bodies(Scheme scheme) {
  Problem problem = problems::block(scheme, Pattern::right, 3, 0.3);
  problem.domain = MeshData{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {3, 0}, {4, 0}, {4, 1}, {3, 1}},
                            {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}},
                            {{"floor", {{0, 1}, {4, 5}}},
                             {"first", {{3, 0}}},
                             {"second", {{7, 4}}},
                             {"sides", {{1, 2}, {5, 6}}},
                             {"roof", {{2, 3}, {6, 7}}}}};
  problem.mesh = {};
  problem.mesh.refine = 3;
  problem.boundary = {{"first", Roller{}},
                      {"second", Roller{}},
                      {"floor", Contact{}},
                      {"roof", Traction{VectorField(0, -0.7)}}};
  return problem;
}

TEST(SeveralBodies, EachIsSolved) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Solution solution = solve(two_bodies(scheme), {ActiveSet{}, {}});
    expect_uniform_stress(solution, {0, -0.7, 0}, 0.7, rounding);
    EXPECT_NEAR(solution.summary.contact.force, 1.4, 1e-11);
  }
}

TEST(SeveralBodies, OneThatNothingHoldsIsNamed) {
  Problem sliding = two_bodies(Scheme::conforming);
  sliding.boundary.erase("second");
  expect_refused(sliding, "the body around (3.5, 0.5)");
  expect_refused(sliding, "translation along (1, 0): no fixed part or roller prevents it, and it slides");

  Problem loose = two_bodies(Scheme::nonconforming);
  loose.boundary["first"] = Fixed{};
  loose.boundary["floor"] = Traction{};
  expect_refused(loose, "the body around (3.5, 0.5)");
  expect_refused(loose, "has no contact");

  Problem lifted = two_bodies(Scheme::conforming);
  lifted.boundary["roof"] =
      Traction{VectorField(0, problems::function([](const Point& x) { return x.x() < 2 ? 0.7 : -0.7; }))};
  expect_refused(lifted, "the body around (0.5, 0.5) but contact");
}

TEST(Mended, AMeshTooCoarseForThePairIsRefinedAndSaysSo) {
  Problem problem = problems::pressed_block(Scheme::nonconforming, Pattern::right, 0.3, 0.007);
  problem.mesh.fineness = Divisions{1, 1};
  problem.boundary["left"] = Fixed{};
  const Solution mended = solve(problem, {ActiveSet{}, {}});
  ASSERT_FALSE(mended.summary.notes.empty());
  EXPECT_NE(mended.summary.notes[0].find("not stable on the 2 triangles"), std::string::npos);
  EXPECT_NE(mended.summary.notes.back().find("makes " + std::to_string(mended.summary.triangles)),
            std::string::npos);
  problem.mesh.fineness = Divisions{4, 4};
  EXPECT_TRUE(solve(problem, {ActiveSet{}, {}}).summary.notes.empty());
}

TEST(Reactions, BalanceTheLoads) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = random_block(3);
    problem.scheme = scheme;
    problem.body = VectorField(0.2, -0.3);
    problem.boundary["bottom"] = Contact{};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    double fx = 0, fy = 0, moment = 0, force = 0;
    for (const Reaction& part : solution.summary.parts) {
      fx += part.force[0];
      fy += part.force[1];
      moment += part.moment;
      if (part.part == "bottom") force = part.force[1];
    }
    EXPECT_NEAR(fx, -0.2 * 2, 1e-11);  // the block has the area 2
    EXPECT_NEAR(fy, 0.3 * 2, 1e-11);
    // The moment of the body force about the origin acts at the centroid (1, 0.5); a weakly symmetric stress
    // keeps it only where the rotation space holds constants, which it does.
    EXPECT_NEAR(moment, -(1 * -0.3 - 0.5 * 0.2) * 2, 1e-10);
    EXPECT_GE(force, 0);
  }
}

TEST(Reactions, BalanceTheMomentsOfLoadsThatVaryWithinATriangle) {
  const auto field = [](const auto& f) {
    return Field([=](const Point& x, const Vector&) { return f(x); }, "/test");
  };
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = random_block(3);
    problem.scheme = scheme;
    problem.body = VectorField(field([](const Point& x) { return x.y(); }),
                               field([](const Point& x) { return -x.x(); }));
    problem.boundary = {
        {"top", Fixed{}},
        {"bottom", Contact{}},
        {"left", Traction{VectorField(field([](const Point& x) { return x.y(); }), Field(1))}}};
    const Solution solution = solve(problem, {ActiveSet{}, {}});
    double moment = 0;
    for (const Reaction& part : solution.summary.parts) {
      moment += part.moment;
      // ∫ (x t_y − y t_x) over x = 0, y from 0 to 1.
      if (part.part == "left") {
        EXPECT_NEAR(part.moment, -1. / 3, 1e-12);
      }
    }
    // −∫ (x f_y − y f_x) over the block from (0, 0) to (2, 1).
    EXPECT_NEAR(moment, 8. / 3 + 2. / 3, 1e-10);
  }
}

}  // namespace
}  // namespace signorini::elasticity_test
