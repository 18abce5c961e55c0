// The bound of the paper's iteration: of the iterate, wherever it was ended.
#include <gtest/gtest.h>

#include "certify/energy_norm.hpp"
#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"
#include "result/true_errors.hpp"
#include "solve.hpp"

namespace signorini::paper_form_bound_test {
namespace {

using problems::SignoriniEdge;

constexpr double kEnergyOfEdge = 1.7216903620444786;  // by Gauss rules on ½ ∮ u σ·n

Exact exact_edge() {
  Exact exact;
  const Field x = problems::formula("1.5*(x^2+y^2)^0.25*cos(0.5*atan2(y,x))"),
              y = problems::formula("-1.5*(x^2+y^2)^0.25*sin(0.5*atan2(y,x))");
  exact.stress = {x, y};
  exact.energy = kEnergyOfEdge;
  return exact;
}

void expect_bounded(const Problem& problem, const PaperUzawa& method) {
  const Solution solution = solve(problem, {method, {}});
  Observer indifferent;
  const TrueErrors errors = true_errors(problem, exact_edge(), solution, indifferent);
  const ErrorBound& bound = solution.summary.error_bound.value();
  SCOPED_TRACE(std::to_string(method.max_iterations) + " iterations");
  EXPECT_TRUE(bound.guaranteed);
  EXPECT_GE(bound.value, *errors.energy_norm);
  EXPECT_LE(bound.energy_lower, kEnergyOfEdge);
  EXPECT_GE(bound.energy_upper, kEnergyOfEdge);
  EXPECT_LE(bound.value, 3 * *errors.energy_norm);
  EXPECT_NEAR(solution.error_squares.sum() / (bound.value * bound.value), 1, 0.9);
}

TEST(PaperFormBound, HoldsForEveryIterate) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const int iterations : {1, 5, 20, 2000})
      expect_bounded(SignoriniEdge::problem(scheme, 8), {0.05, 1, 1, 1e-12, iterations});
}

TEST(PaperFormBound, HoldsForAnIterationThatDiverges) {
  expect_bounded(SignoriniEdge::problem(Scheme::conforming, 4), {0.5, 0, 1, 1e-5, 10});
}

/// A stripe so thin that the cells through which the law jumps are not cut to nothing.
TEST(PaperFormBound, IsThereForAThinSoftStripe) {
  Problem problem = problems::paper(Scheme::nonconforming, 3);
  problem.material = MembraneStiffness::isotropic(problems::formula(
      "abs(0.4535961214255773*x + 0.8912073600614354*y - 0.5415828513914194) < 0.003 ? 0.01 : 1"));
  problem.boundary = {{"left", Fixed{}}, {"right", Contact{1e6}}};
  const ErrorBound exact = solve(problem, {ActiveSet{}, {}}).summary.error_bound.value(),
                   early = solve(problem, {PaperUzawa{0.5, 10, 0, 1e-5, 3}, {}}).summary.error_bound.value();
  EXPECT_TRUE(early.guaranteed);
  EXPECT_DOUBLE_EQ(early.energy_upper, exact.energy_upper);
  EXPECT_GT(early.value, exact.value);
}

/// κ = 1 + ½ sin(9 x): (C τ, τ) of a constant stress on the unit square, by the integral of 1 / κ.
TEST(EnergyNorm, OfAStressCountsTheLawWithinATriangle) {
  Problem problem = problems::paper(Scheme::nonconforming, 3);
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.5*sin(9*x)"));
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  const Discretization discretization(problem, *solution.mesh);
  // The outward fluxes of (1, 0), from the corners of each triangle.
  Eigen::MatrixXd stress(3, discretization.triangles());
  for (int t = 0; t < discretization.triangles(); ++t) {
    const auto corners = solution.mesh->corners(t);
    for (int e = 0; e < 3; ++e) stress(e, t) = corners[(e + 2) % 3].y() - corners[(e + 1) % 3].y();
  }
  double integral = 0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) integral += 1 / (1 + 0.5 * std::sin(9 * (i + 0.5) / n)) / n;
  const LawOnMesh laws(problem.material, *solution.mesh, 1e-8, progress);
  const double square = energy_norm_squares(discretization, stress, laws, progress).sum();
  EXPECT_GE(square, integral * (1 - 1e-9));
  EXPECT_NEAR(square, integral, 1e-6 * integral);
}

/// A rule that looks at the law coarsely may see too little of it, which is made up for on each triangle.
TEST(EnergyNorm, IsFromAboveOnEveryTriangle) {
  Problem problem = problems::paper(Scheme::nonconforming, 3);
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.5*sin(9*x)"));
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Mesh mesh = rectangle_mesh(Rectangle{}, {3, 3}, Pattern::right);
  const Discretization discretization(problem, mesh);
  const Eigen::MatrixXd stress = Eigen::MatrixXd::Random(3, discretization.triangles());
  const auto squares = [&](double tolerance) {
    return energy_norm_squares(discretization, stress, {problem.material, mesh, tolerance, progress},
                               progress);
  };
  const Eigen::VectorXd coarse = squares(0.3), close = squares(1e-10);
  for (int t = 0; t < discretization.triangles(); ++t) EXPECT_GE(coarse[t], close[t] * (1 - 1e-9)) << t;
}

}  // namespace
}  // namespace signorini::paper_form_bound_test
