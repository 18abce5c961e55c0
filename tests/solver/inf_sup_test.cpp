// The constant of the Babuška–Brezzi condition: where it is known, that it is bounded below for the pairs
// that are stable and not for those that are not.
#include "fem/inf_sup.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "fem/stability.hpp"
#include "mesh/domain_mesh.hpp"
#include "problems/elasticity.hpp"
#include "problems/sanitized.hpp"

namespace signorini::inf_sup_test {
namespace {

constexpr std::array kSchemes{Scheme::conforming, Scheme::nonconforming};

double constant(const Problem& problem, const Mesh& mesh, Bubbles bubbles = Bubbles::kept) {
  Observer nobody;
  Progress progress(nobody, std::nullopt);
  return inf_sup_constant(problem, mesh, progress, bubbles);
}

double constant(const Problem& problem, Bubbles bubbles = Bubbles::kept) {
  return constant(problem, make_domain_mesh(problem.domain, problem.mesh), bubbles);
}

/// A square, n times n squares, held above and with contact below.
Problem square(Scheme scheme, int n, Pattern pattern = Pattern::right) {
  Problem problem = problems::block(scheme, pattern, 200, 0.3);
  problem.domain = Rectangle{{0, 0}, {1, 1}};
  problem.mesh.fineness = Divisions{n, n};
  problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{}}};
  return problem;
}

/// Where a function that is positive at the one end and negative at the other is zero.
double root(double positive, double negative, const std::function<double(double)>& function) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (positive + negative) / 2;
    (function(middle) > 0 ? positive : negative) = middle;
  }
  return positive;
}

TEST(InfSup, IsBoundedBelowForBothSchemesAndModels) {
  for (const Scheme scheme : kSchemes)
    for (const bool is_elastic : {false, true}) {
      std::vector<double> constants;
      for (int n = 4; n <= (sanitized ? 16 : 64); n *= 2) {
        constants.push_back(constant(is_elastic ? square(scheme, n) : problems::paper(scheme, n)));
        EXPECT_GT(constants.back(), is_elastic ? 0.28 : 0.86) << n;
      }
      const auto [least, most] = std::minmax_element(constants.end() - 3, constants.end());
      EXPECT_LT(*most, 1.1 * *least);
    }
}

/// (div τ, v) = (div τ, Δφ) is largest for τ = ∇φ. Where v is an eigenfunction of −Δ, with the eigenvalue κ,
/// that makes β² = κ / (1 + κ).
TEST(InfSup, OfAMembraneThatNothingTouchesIsThatOfItsLeastTone) {
  for (const Scheme scheme : kSchemes)
    for (const auto& [sides, tone] :
         {std::pair(4, 2 * std::numbers::pi * std::numbers::pi), {2, std::numbers::pi * std::numbers::pi}}) {
      Problem problem = problems::paper(scheme, 16);
      problem.boundary = {{"left", Fixed{}}, {"right", Fixed{}}};
      if (sides == 4) problem.boundary.insert({{"bottom", Fixed{}}, {"top", Fixed{}}});
      EXPECT_NEAR(constant(problem), std::sqrt(tone / (1 + tone)), 1e-4);
    }
}

/// Without discretization the supremum for (v, μ) is the least √(‖∇w‖² + ‖v − w‖²) of all w with w = μ on Γ_C
/// and 0 on Γ_D, and the norm of μ the least √(‖∇z‖² + ‖z‖²) of all such z. On the paper's square with
/// contact at y = ±1/2 the least quotient β² = θ has w = sin πx cosh qy and z = sin πx cosh ky.
TEST(InfSup, OfThePapersProblemTendsToTheValueInClosedForm) {
  const double pi2 = std::numbers::pi * std::numbers::pi, k = std::sqrt(1 + pi2);
  const double exact = std::sqrt(root(0.1, 0.9, [&](double theta) {
    const double q = std::sqrt(pi2 - theta / (1 - theta));
    return q * std::tanh(q / 2) - theta * k * std::tanh(k / 2);
  }));
  for (const Scheme scheme : kSchemes) {
    double before = 1;
    for (const int n : {16, 32, 64}) {
      const double error = constant(problems::paper(scheme, n)) - exact;
      EXPECT_GT(error, 0);
      EXPECT_LT(error, 0.7 * before);
      before = error;
    }
    EXPECT_LT(before, 0.015);
  }
}

/// The same for an elastic bar between rollers, fixed above, with contact below: w = sin q(h − y) and z =
/// sinh (h − y) across, for the height h where the area is 1.
TEST(InfSup, OfABarBetweenRollersTendsToTheValueInClosedForm) {
  const double h = 8;
  const double exact = std::sqrt(root(1e-6, 0.036, [&](double theta) {
    const double q = std::sqrt(theta / (1 - theta));
    return q / std::tan(q * h) - theta / std::tanh(h);
  }));
  for (const Scheme scheme : kSchemes) {
    Problem problem = square(scheme, 1);
    problem.domain = Rectangle{{0, 0}, {1, 64}};
    problem.mesh.fineness = Divisions{2, 128};
    problem.boundary.insert({{"left", Roller{}}, {"right", Roller{}}});
    EXPECT_NEAR(constant(problem), exact, 0.01 * exact);
  }
}

TEST(InfSup, IsTheLeastEigenvalueOfTheDenseMatrices) {
  for (const Scheme scheme : kSchemes) {
    const Problem problem = square(scheme, 2, Pattern::crossed);
    Observer nobody;
    Progress progress(nobody, std::nullopt);
    const InfSupForms forms =
        inf_sup_forms(problem, make_domain_mesh(problem.domain, problem.mesh), Bubbles::kept, progress);
    const int s = forms.stresses, n = forms.multipliers, w = forms.extensions;
    const Eigen::MatrixXd coupled = Eigen::MatrixXd(forms.coupled).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd norms = Eigen::MatrixXd(forms.norms).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd b = coupled.block(s, 0, n, s), extension = norms.block(s, s + n, n, w);
    const Eigen::MatrixXd supremum = b * coupled.topLeftCorner(s, s).llt().solve(b.transpose());
    const Eigen::MatrixXd norm = norms.block(s, s, n, n) -
                                 extension * norms.bottomRightCorner(w, w).llt().solve(extension.transpose());
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> dense(supremum, norm);
    EXPECT_NEAR(constant(problem), std::sqrt(dense.eigenvalues()[0]), 1e-7);
  }
}

TEST(InfSup, OfRowsOfRT0WithoutTheirBubblesIsZeroOnEveryMesh) {
  for (const Pattern pattern : {Pattern::right, Pattern::alternating, Pattern::crossed})
    for (const int n : {4, 8, 16}) {
      const Problem problem = square(Scheme::nonconforming, n, pattern);
      EXPECT_LT(constant(problem, Bubbles::left_out), 1e-6);
      EXPECT_GT(constant(problem), 0.28);
    }
}

/// A body of three triangles is held by two edges, the shorter one of which shrinks.
TEST(InfSup, FallsOnMeshesThatTheStabilityCheckMendsAndNotOnTheMendedOnes) {
  double before = 1;
  for (const double shorter : {0.1, 0.025, 0.00625, 0.0015625}) {
    Problem problem = square(Scheme::nonconforming, 1);
    problem.domain = MeshData{{{0, 0}, {2, 0}, {2, 1}, {0, 1}, {0, shorter}},
                              {{0, 1, 4}, {4, 1, 2}, {4, 2, 3}},
                              {{"left", {{3, 4}, {4, 0}}}, {"right", {{1, 2}}}, {"rest", {{0, 1}, {2, 3}}}}};
    problem.boundary = {{"left", Fixed{}}, {"right", Contact{}}};
    const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh), mended = stabilized(problem, mesh);
    const double here = constant(problem, mesh);
    EXPECT_LT(here, 0.6 * before) << shorter;
    EXPECT_GT(constant(problem, mended), 0.12) << shorter;
    before = here;
  }
}

TEST(InfSup, OfAStripHeldByOneEdgeIsZeroUntilItIsMended) {
  Problem problem = square(Scheme::nonconforming, 1);
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{}}};
  problem.domain = Rectangle{{0, 0}, {4, 1}};
  problem.mesh.fineness = Divisions{4, 1};
  const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
  EXPECT_LT(constant(problem, mesh), 1e-6);
  EXPECT_GT(constant(problem, stabilized(problem, mesh)), 0.03);
}

TEST(InfSup, OfABodyThatContactAloneHoldsIsZero) {
  for (const Scheme scheme : kSchemes)
    EXPECT_LT(constant(problems::pressed_block(scheme, Pattern::crossed, 0.3, 1)), 1e-6);
}

TEST(InfSup, IsBoundedBelowOnArcsAndForDirections) {
  for (const Scheme scheme : kSchemes)
    for (const auto& condition : {Contact{Field(1)}, Contact{Field(1), Vector(0, -1)}}) {
      Problem problem = problems::half_disc(scheme);
      problem.boundary["arc"] = condition;
      problem.mesh.fineness = LargestEdge{0.1};
      const double coarse = constant(problem);
      problem.mesh.fineness = LargestEdge{0.05};
      EXPECT_GT(coarse, 0.3);
      EXPECT_NEAR(constant(problem), coarse, 0.1 * coarse);
    }
}

TEST(InfSup, IsTheSameInAllUnitsAndForAllMaterials) {
  for (const Scheme scheme : kSchemes) {
    const Problem problem = square(scheme, 6);
    Problem bar = problem;
    bar.boundary["left"] = Roller{};
    for (const Problem& one : {problem, bar})
      for (const double length : {1e-9, 1e9}) {
        Problem scaled = one;
        scaled.domain = Rectangle{{3 * length, length}, {length, length}};
        scaled.material = YoungPoisson{Field(2.1e11), Field(0.4999)};
        EXPECT_NEAR(constant(scaled), constant(one), 1e-7);
      }
  }
}

TEST(InfSup, OfASingleTriangleIsFound) {
  Problem problem;
  problem.domain = MeshData{{{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}, {{"rim", {{0, 1}, {1, 2}, {2, 0}}}}};
  problem.boundary = {{"rim", Fixed{}}};
  for (const Scheme scheme : kSchemes) {
    problem.scheme = scheme;
    EXPECT_GT(constant(problem), 0.5);
  }
}

/// It is asked every few milliseconds, whatever it does: no piece of it goes on for long.
TEST(InfSup, EndsWhereverTheObserverEndsIt) {
  struct Watch : Observer {
    int left = 0, asked = 0;
    std::clock_t before = std::clock(), longest = 0;
    bool keep_going() override {
      const std::clock_t now = std::clock();
      longest = std::max(longest, now - before);
      before = now;
      ++asked;
      return left-- > 0;
    }
  };
  const Problem problem = square(Scheme::conforming, sanitized ? 8 : 48);
  const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
  Watch all;
  all.left = std::numeric_limits<int>::max();
  Progress progress(all, {});
  const std::clock_t begun = std::clock();
  inf_sup_constant(problem, mesh, progress);
  EXPECT_LT(all.longest, (std::clock() - begun) / 4);
  for (const int share : {0, 10, 50, 90}) {
    Watch impatient;
    impatient.left = all.asked / 100 * share;
    Progress interrupted(impatient, {});
    EXPECT_THROW(inf_sup_constant(problem, mesh, interrupted), Cancelled);
    EXPECT_EQ(impatient.asked, all.asked / 100 * share + 1);
  }
}

}  // namespace
}  // namespace signorini::inf_sup_test
