// Loads that jump along curves.
#include "fem/load_projection.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fem/lagrange.hpp"
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
double integral(const ProjectedLoad& load, const std::array<Point, 3>& corners) {
  return area(corners) / 3 * load.projection.rightCols<3>().sum();
}

double integral(const LoadProjection& loads, const Mesh& mesh) {
  double sum = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    sum += integral(loads[t], mesh.corners(t));
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

/// ‖f − p‖ on a triangle, by the middles of many pieces, for the values p at the nodes.
double distance(const Field& f, const ProjectedLoad::Nodes& nodes, const std::array<Point, 3>& corners) {
  constexpr int n = 40;
  const AffineMap map(corners);
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - i; ++j)
      for (const double at : {1. / 3, 2. / 3}) {
        if (at > 0.5 && j == n - i - 1) continue;
        const Point x((i + at) / n, (j + at) / n);
        const double off = f(map(x)) - (nodes * quadratic_basis(x))[0];
        sum += map.determinant / 2 / (n * n) * off * off;
      }
  return std::sqrt(sum);
}

/// What is known of two loads is known of their sum, by as much as both are off.
TEST(LoadProjection, OfASumIsTheSum) {
  const std::string smooth = "sin(9*x) * y", jump = "x + 2*y < 1.1 ? 5 : -1", constant = "2";
  const Problem paper = problems::paper(Scheme::conforming, 4);
  const Mesh mesh = make_domain_mesh(paper.domain, paper.mesh);
  const auto projected = [&](const VectorField& load) {
    Problem problem = paper;
    problem.body = load;
    return LoadProjection(problem, mesh);
  };
  for (const auto& [one, other] :
       {std::pair{smooth, jump}, {jump, smooth}, {constant, smooth}, {smooth, constant}, {jump, jump}})
    for (const double z : {0.7, -3.}) {
      SCOPED_TRACE(one + " and " + std::to_string(z) + " times " + other);
      const Field f = problems::formula(one), q = problems::formula(other);
      const VectorField both(f.plus(z, q));
      const LoadProjection whole = projected(both), of_f = projected(f), of_q = projected(q);
      double uncertain = 0, integral_of_sum = 0;
      for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
        const ProjectedLoad sum = of_f[t].plus(z, of_q[t]);
        integral_of_sum += integral(sum, mesh.corners(t));
        uncertain += sum.uncertain_force + whole[t].uncertain_force;
        constexpr double of_sampling = 1.1, rounding = 1e-9;
        EXPECT_LE(distance(both.fields()[0], sum.projection, mesh.corners(t)),
                  of_sampling * sum.rest + rounding);
        EXPECT_LE(distance(both.fields()[0], sum.balanced, mesh.corners(t)),
                  of_sampling * sum.unbalanced + rounding);
        EXPECT_GE(sum.uncertain_work, sum.uncertain_force);
      }
      EXPECT_NEAR(integral_of_sum, integral(whole, mesh), uncertain + 1e-9);
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
