#include "certify/data/jump_oscillation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

#include "certify/data/linear_remainder.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "mesh/refine.hpp"
#include "problems/membrane.hpp"

namespace signorini::jump_oscillation_test {
namespace {

using Corners = std::array<Point, 3>;

Mesh cut(const Corners& corners, int times) {
  return refine(
      make_mesh({corners.begin(), corners.end()}, {{0, 1, 2}}, {""}, {{{1, 2}, 0}, {{2, 0}, 0}, {{0, 1}, 0}}),
      times);
}

/// (f − Πf, w) / ‖ε(w)‖ of the best continuous w that is linear on each of 4ⁿ triangles: less than that of
/// all w.
template <int D>
double by_elements(const VectorField& load, const ProjectedLoad& projected, const Corners& corners,
                   int cuts) {
  const Mesh mesh = cut(corners, cuts);
  const AffineMap whole(corners);
  const int size = D * static_cast<int>(mesh.points.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd work = Eigen::VectorXd::Zero(size);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const AffineMap map(mesh.corners(t));
    Eigen::Matrix<double, 3, 2> gradients;
    gradients << -1, -1, 1, 0, 0, 1;
    gradients = (gradients * map.jacobian.inverse()).eval();
    for (int z = 0; z < 3; ++z)
      for (int y = 0; y < 3; ++y)
        for (int c = 0; c < D; ++c)
          for (int d = 0; d < D; ++d) {
            const double turned = D == 1 ? 0 : gradients(z, d) * gradients(y, c);
            const double straight = c == d ? gradients.row(z).dot(gradients.row(y)) : 0;
            entries.emplace_back(D * mesh.triangles[t][z] + c, D * mesh.triangles[t][y] + d,
                                 map.determinant / 2 * (D == 1 ? straight : (straight + turned) / 2));
          }
  }
  // The rule does not see where in a triangle f jumps: what is linear in its values is no part of f − Πf.
  const Eigen::Index points = static_cast<Eigen::Index>(mesh.triangles.size()) * TriangleRule::size;
  Eigen::MatrixXd rest(points, D), linear(points, 3), basis(points, 3);
  Eigen::VectorXd weights(points);
  for (Eigen::Index i = 0; i < points; ++i) {
    const int t = static_cast<int>(i / TriangleRule::size), q = static_cast<int>(i % TriangleRule::size);
    const AffineMap map(mesh.corners(t));
    const Point x = map(triangle_rule().points[q]);
    const Point there = whole.jacobian.inverse() * (x - whole.origin);
    weights[i] = triangle_rule().weights[q] * map.determinant;
    basis.row(i) = triangle_basis(1, triangle_rule().points[q]).transpose();
    linear.row(i) << 1, there.transpose();
    rest.row(i) = -(projected.balanced * quadratic_basis(there)).transpose();
    for (int c = 0; c < D; ++c) rest(i, c) += load(c, x);
  }
  const Eigen::MatrixXd tested = linear.transpose() * weights.asDiagonal();
  rest -= (linear * (tested * linear).inverse() * (tested * rest)).eval();
  for (Eigen::Index i = 0; i < points; ++i)
    for (int z = 0; z < 3; ++z)
      work.segment<D>(D * mesh.triangles[i / TriangleRule::size][z]) +=
          weights[i] * basis(i, z) * rest.row(i);
  Eigen::SparseMatrix<double> stiffness(size, size);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  // Rigid motions are held by a little stiffness of their own: the load does no work on them.
  for (int i = 0; i < size; ++i) stiffness.coeffRef(i, i) += 1e-8;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(stiffness);
  return std::sqrt(work.dot(factor.solve(work)));
}

template <int D>
void expect_close(const VectorField& load, const Corners& corners, double most) {
  Problem problem;
  problem.body = load;
  if (D == 2) problem.material = YoungPoisson{Field(1), Field(0.), Plane::strain};
  const LoadProjection projection(problem, cut(corners, 0));
  const ProjectedLoad& projected = projection[0];
  ASSERT_TRUE(projected.jumps);
  CellBudget budget{1000};
  const double least = by_elements<D>(load, projected, corners, 6),
               bound = jump_oscillation<D>(load, projected, corners, budget);
  EXPECT_GE(bound, least);
  EXPECT_LE(bound, most * least);
  EXPECT_LE(bound, 0.9 * linear_remainder<D>(corners) * projected.unbalanced);
}

const Corners half_square{Point(2, 1), Point(3, 1), Point(2, 2)};

TEST(JumpOscillation, OfAMembraneIsCloseToTheWorkThatAJumpCanDo) {
  for (const char* load : {"x < 2.3 ? 10 : -10", "x + 0.7*y < 3.21 ? 10 : -5", "y - 0.4*x > 0.4",
                           "sign(x - 2.5) * x", "(x - 2.2)^2 + (y - 1.3)^2 < 0.04"}) {
    SCOPED_TRACE(load);
    expect_close<1>(problems::formula(load), half_square, 1.35);
  }
}

TEST(JumpOscillation, OfAnElasticBodyIsCloseToTheWorkThatAJumpCanDo) {
  for (const char* load : {"x < 2.3 ? 10 : -10", "x + 0.7*y < 3.21 ? 10 : -5", "y - 0.4*x > 0.4"}) {
    SCOPED_TRACE(load);
    expect_close<2>(VectorField(Field(0), problems::formula(load)), half_square, 1.85);
    expect_close<2>(VectorField(problems::formula(load), problems::formula("y < 1.4 ? 1 : -1")), half_square,
                    1.85);
  }
}

/// However the triangle lies and whatever its size, also where it is like none of the references.
TEST(JumpOscillation, IsABoundOnAnyTriangle) {
  const auto load = problems::formula("x + 0.7*y < 3.21 ? 10 : -5");
  for (const Corners& corners :
       {Corners{Point(2, 2), Point(2, 1), Point(3, 1)}, Corners{Point(2, 1), Point(3, 1.1), Point(2.4, 1.9)},
        Corners{Point(2, 1), Point(4, 1.2), Point(3, 1.3)}}) {
    expect_close<1>(load, corners, 3);
    expect_close<2>(VectorField(load, load), corners, 20);
  }
}

/// Of what waves faster than the cells of a triangle are small, no more is known than between which values it
/// lies: here it is always the jump.
TEST(JumpOscillation, CountsWhatIsNotKnownOfTheLoad) {
  const std::string one = "(cos(1000000*x)^2 + sin(1000000*x)^2 > 0.5 ? 1 : -1)";
  const Field jump = problems::formula("(x < 2.3 ? 10 : -10) * " + one);
  const auto expect_bound = [](const VectorField& load, auto components) {
    constexpr int d = components;
    Problem problem;
    problem.body = load;
    if (d == 2) problem.material = YoungPoisson{Field(1), Field(0.), Plane::strain};
    const LoadProjection projection(problem, cut(half_square, 0));
    const ProjectedLoad& projected = projection[0];
    ASSERT_TRUE(projected.jumps);
    CellBudget budget{1000};
    EXPECT_GE(jump_oscillation<d>(load, projected, half_square, budget),
              by_elements<d>(load, projected, half_square, 4));
  };
  expect_bound(jump, std::integral_constant<int, 1>());
  expect_bound(VectorField(jump, jump), std::integral_constant<int, 2>());
}

}  // namespace
}  // namespace signorini::jump_oscillation_test
