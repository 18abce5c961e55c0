// Loads that jump along curves.
#include "fem/load_projection.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "mesh/domain_mesh.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"

namespace signorini::load_projection_test {
namespace {

double area(const std::array<Point, 3>& corners) {
  const Vector a = corners[1] - corners[0], b = corners[2] - corners[0];
  return (a.x() * b.y() - a.y() * b.x()) / 2;
}

/// The integrals of quadratic functions: by the middles of the edges.
double integral(const LoadProjection& loads, const Mesh& mesh) {
  double sum = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    sum += area(mesh.corners(t)) / 3 * loads[t].projection.rightCols<3>().sum();
  return sum;
}

/// Cells that the first triangles along the curve use up would leave the others with a load that is off by
/// all of it.
TEST(LoadProjection, SharesItsCellsAmongAllTrianglesAlongACurve) {
  const double exact = 10 * (2 * std::numbers::pi * 0.288 * 0.288 - 1);
  for (const int n : sanitized ? std::vector{2, 8} : std::vector{2, 8, 32, 64}) {
    Problem problem = problems::paper(Scheme::conforming, n);
    problem.body = problems::formula("(x - 0.45)^2 + (y - 0.55)^2 < 0.288^2 ? 10 : -10");
    const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
    const LoadProjection loads(problem, mesh);
    EXPECT_TRUE(loads.unmet().empty());
    double uncertain = 0;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) uncertain += loads[t].uncertain_force;
    EXPECT_LE(uncertain, 1e-4) << n;
    EXPECT_GT(uncertain, 0) << n;
    EXPECT_NEAR(integral(loads, mesh), exact, uncertain) << n;
  }
}

/// Rounding, beside the numbers on a triangle, must not hide a place that is small but where the load is not.
TEST(LoadProjection, OverlooksNoPeak) {
  const auto expect_one = [](const std::string& load, int n) {
    SCOPED_TRACE(load + " on " + std::to_string(n) + " squares");
    Problem problem = problems::paper(Scheme::conforming, n);
    problem.body = problems::formula(load);
    const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
    const LoadProjection loads(problem, mesh);
    double uncertain = 0;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) uncertain += loads[t].uncertain_force;
    EXPECT_NEAR(integral(loads, mesh), 1, uncertain + 1e-9);
  };
  // A vertex, the middle of an edge, and no point of the mesh.
  for (const auto& [a, b] : {std::pair{"0.5", "0.5"}, {"0.625", "0.5"}, {"0.51", "0.52"}})
    for (const double radius : {1e-6, 1e-8, 1e-9, 1e-12}) {
      const std::string square = problems::digits(radius * radius);
      expect_one("(x - " + std::string(a) + ")^2 + (y - " + b + ")^2 < " + square + " ? 1 / (pi * " + square +
                     ") : 0",
                 4);
    }
  expect_one("(x - 0.51)^2 < 1e-18 ? 5e8 : 0", 4);
  expect_one("(x - 0.5)^2 < 1e-18 ? 5e8 : 0", 4);
}

/// Beside what a quotient divides by, its enclosure is without bound, or as good as that, and its values are
/// not.
TEST(LoadProjection, HasTheValuesOfAQuotientOfWhatVanishes) {
  const auto expect = [](const std::string& load, double exact, double tolerance) {
    for (const int n : {4, 16}) {
      SCOPED_TRACE(load + " on " + std::to_string(n) + " squares");
      Problem problem = problems::paper(Scheme::conforming, n);
      problem.body = problems::formula(load);
      const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
      const LoadProjection loads(problem, mesh);
      EXPECT_NEAR(integral(loads, mesh), exact, tolerance);
      if (!loads.unmet().empty()) continue;
      double uncertain = 0;
      for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) uncertain += loads[t].uncertain_force;
      EXPECT_NEAR(integral(loads, mesh), exact, uncertain);
    }
  };
  const double sine = 0.979726;  // ∫ sin(x - 0.3) / (x - 0.3)
  expect("sin(x - 0.3) / (x - 0.3)", sine, 1e-5);
  expect("abs(x - 0.3) < 1e-12 ? 1 : sin(x - 0.3) / (x - 0.3)", sine, 1e-3);
  expect("abs(x - 0.25) < 1e-12 ? 1 : sin(x - 0.25) / (x - 0.25)", 0.976088, 1e-3);
  expect("(x^2 - 0.09) / (x - 0.3)", 0.8, 1e-9);
  expect("abs(x - 0.3) < 1e-7 ? 0.6 : (x^2 - 0.09) / (x - 0.3)", 0.8, 1e-4);
  expect("x * log(x)", -0.25, 1e-4);
}

}  // namespace
}  // namespace signorini::load_projection_test
