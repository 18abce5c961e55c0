// The defining properties of RT0 and RT1 on randomly shaped triangles.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <random>

#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "fem/raviart_thomas.hpp"

namespace signorini::elements_test {
namespace {

std::array<Point, 3> random_triangle(std::mt19937& engine) {
  std::uniform_real_distribution<> number(-2, 2);
  for (;;) {
    const std::array<Point, 3> corners{Point(number(engine), number(engine)),
                                       Point(number(engine), number(engine)),
                                       Point(number(engine), number(engine))};
    if (AffineMap(corners).determinant > 0.2) return corners;
  }
}

const std::array<Point, 3> kReference{Point(0, 0), Point(1, 0), Point(0, 1)};

/// All functionals of a vector field given in reference coordinates: outward flux moments edge by edge,
/// then for RT1 the interior moments pulled back to the reference triangle.
template <typename FieldOfReference>
LocalVector functionals(const RaviartThomas& element, const std::array<Point, 3>& corners,
                        const FieldOfReference& tau) {
  const AffineMap map(corners);
  LocalVector values = LocalVector::Zero(element.size());
  const int per_edge = element.functions_per_edge();
  for (int e = 0; e < 3; ++e) {
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const Vector along = corners[b] - corners[a];
    const Vector normal(along.y(), -along.x());  // as long as the edge
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const Point reference = kReference[a] + s * (kReference[b] - kReference[a]);
      values.segment(e * per_edge, per_edge) +=
          edge_rule().weights[q] * normal.dot(tau(reference)) * edge_basis(element.order(), s);
    }
  }
  if (element.order() == 1)
    for (int q = 0; q < TriangleRule::size; ++q)
      values.tail(2) += triangle_rule().weights[q] * map.determinant *
                        (map.jacobian.inverse() * tau(triangle_rule().points[q]));
  return values;
}

class Elements : public testing::TestWithParam<int> {
 protected:
  RaviartThomas element_{GetParam()};
  std::mt19937 engine_{7};
};

TEST_P(Elements, FunctionalIOfFunctionJIsDelta) {
  for (int trial = 0; trial < 50; ++trial) {
    const auto corners = random_triangle(engine_);
    const AffineMap map(corners);
    for (int j = 0; j < element_.size(); ++j) {
      const LocalVector values = functionals(
          element_, corners, [&](const Point& x) -> Vector { return element_.values(map, x).col(j); });
      for (int i = 0; i < element_.size(); ++i)
        EXPECT_NEAR(values[i], i == j ? 1 : 0, 1e-12) << i << " of " << j;
    }
  }
}

TEST_P(Elements, NormalTraceVanishesOnOtherEdges) {
  const auto corners = random_triangle(engine_);
  const AffineMap map(corners);
  for (int j = 0; j < element_.edge_functions(); ++j)
    for (int e = 0; e < 3; ++e) {
      if (j / element_.functions_per_edge() == e) continue;
      const Vector along = corners[(e + 2) % 3] - corners[(e + 1) % 3];
      for (const double s : {0., 0.3, 1.}) {
        const Point x = kReference[(e + 1) % 3] + s * (kReference[(e + 2) % 3] - kReference[(e + 1) % 3]);
        const Vector tau = element_.values(map, x).col(j);
        EXPECT_NEAR(along.y() * tau.x() - along.x() * tau.y(), 0, 1e-12);
      }
    }
}

TEST_P(Elements, ReproducesConstantsAndLinears) {
  for (int trial = 0; trial < 20; ++trial) {
    const auto corners = random_triangle(engine_);
    const AffineMap map(corners);
    Eigen::Matrix2d slope = Eigen::Matrix2d::Random();
    if (element_.order() == 0) slope = 0.7 * Eigen::Matrix2d::Identity();  // RT0 holds the field x itself
    const auto field = [&](const Point& x) -> Vector { return Vector(0.3, -1.1) + slope * map(x); };
    const LocalVector coefficients = functionals(element_, corners, field);
    const LocalVector interpolated =
        element_.interpolate(map, [&](const Point& x) -> Vector { return Vector(0.3, -1.1) + slope * x; });
    EXPECT_LT((interpolated - coefficients).norm(), 1e-12);
    for (const Point& x : triangle_rule().points) {
      EXPECT_LT((element_.values(map, x) * coefficients - field(x)).norm(), 1e-12);
      EXPECT_NEAR(element_.reference_divergences(x).dot(coefficients) / map.determinant, slope.trace(),
                  1e-11);
    }
  }
}

TEST_P(Elements, DivergenceTheoremHoldsForEveryFunction) {
  for (int j = 0; j < element_.size(); ++j) {
    double volume = 0;
    for (int q = 0; q < TriangleRule::size; ++q)
      volume += triangle_rule().weights[q] * element_.reference_divergences(triangle_rule().points[q])[j];
    EXPECT_NEAR(volume, j < element_.edge_functions() ? 1 : 0, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(RaviartThomas, Elements, testing::Values(0, 1),
                         [](const auto& test) { return "RT" + std::to_string(test.param); });

double power(double x, int n) {
  return std::pow(x, n);
}

template <typename Rule>
void expect_exact(const Rule& rule, int degree) {
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) {
      double sum = 0;
      for (int q = 0; q < Rule::size; ++q) {
        const Point& x = rule.points[q];
        EXPECT_GT(x.minCoeff(), 0);
        EXPECT_LT(x.sum(), 1);
        sum += rule.weights[q] * power(x.x(), i) * power(x.y(), j);
      }
      // ∫ x^i y^j = i! j! / (i + j + 2)!
      EXPECT_NEAR(sum, std::tgamma(i + 1) * std::tgamma(j + 1) / std::tgamma(i + j + 3), 1e-15);
    }
}

TEST(EdgeBasis, ProjectsItsOwnFunctionsOntoThemselves) {
  for (const int order : {0, 1, 2})
    for (int k = 0; k <= order; ++k) {
      const auto own = [&](double s) { return edge_basis(order, s)[k]; };
      const LocalVector projection = project_onto_edge(order, edge_moments(order, own));
      for (int j = 0; j <= order; ++j) EXPECT_NEAR(projection[j], j == k ? 1 : 0, 1e-14);
      const Eigen::Vector3d at_nodes = projection_at_nodes(order, own);
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(at_nodes[i], own(std::array{0., 1., 0.5}[i]), 1e-14);
    }
}

TEST(Quadrature, IsExactToItsDegree) {
  expect_exact(triangle_rule(), 5);
  expect_exact(fine_triangle_rule(), 6);
  for (int i = 0; i <= 9; ++i) {
    double sum = 0;
    for (int q = 0; q < EdgeRule::size; ++q) sum += edge_rule().weights[q] * power(edge_rule().points[q], i);
    EXPECT_NEAR(sum, 1. / (i + 1), 1e-15);
  }
}

}  // namespace
}  // namespace signorini::elements_test
