#include "certify/data/linear_remainder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "certify/data/local_equilibrium.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "mesh/refine.hpp"

namespace signorini::linear_remainder_test {
namespace {

/// The triangle cut into similar ones, four times as many each time. Part e of the boundary is its edge e.
Mesh cut(const std::array<Point, 3>& corners, int times) {
  return refine(make_mesh({corners.begin(), corners.end()}, {{0, 1, 2}}, {"0", "1", "2"},
                          {{{1, 2}, 0}, {{2, 0}, 1}, {{0, 1}, 2}}),
                times);
}

/// max over x of min zᵀ energy z, over z with loads z = x, xᵀ mass x = 1 and xᵀ mass linear = 0; its root.
/// The loads of stresses have no rigid motions.
template <int D>
double largest_least(const Eigen::MatrixXd& energy, const Eigen::MatrixXd& loads, const Eigen::MatrixXd& mass,
                     const Eigen::MatrixXd& linear) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(loads.transpose());
  const Eigen::Index rank = qr.rank(), rest = loads.cols() - rank;
  EXPECT_EQ(rank, loads.rows() - (D == 1 ? 1 : 3));  // all but the rigid motions of the whole
  const Eigen::MatrixXd q = qr.householderQ();
  const Eigen::MatrixXd idle = q.rightCols(rest), x_of = loads * q.leftCols(rank);
  Eigen::MatrixXd orthogonal = Eigen::MatrixXd::Identity(rank, rank);
  if (linear.cols() > 0) {
    Eigen::FullPivLU<Eigen::MatrixXd> tested(linear.transpose() * mass * x_of);
    tested.setThreshold(1e-9);  // the loads have no rigid motion already, but for rounding
    orthogonal = tested.kernel();
    EXPECT_EQ(orthogonal.cols(), loads.rows() - linear.cols());
  }
  const Eigen::MatrixXd loading = q.leftCols(rank) * orthogonal, x = x_of * orthogonal;
  const Eigen::MatrixXd own = idle.transpose() * energy * idle, mixed = idle.transpose() * energy * loading;
  const Eigen::MatrixXd least =
      loading.transpose() * energy * loading - mixed.transpose() * own.ldlt().solve(mixed);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(least, x.transpose() * mass * x,
                                                                        Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues().maxCoeff());
}

/// The largest norm of the least stress for a load of norm 1 that is orthogonal to the linear ones, without
/// traction on the boundary.
template <int D>
double constant_of_loads(const Mesh& mesh) {
  const LocalEquilibrium<D> stresses(mesh);
  return largest_least<D>(stresses.energy, stresses.loads, stresses.mass, stresses.linear);
}

/// (q, q') of tractions that are linear on each of the edges.
template <int D>
Eigen::MatrixXd mass_of_tractions(const Mesh& mesh, const std::vector<int>& loaded) {
  const Eigen::Index rows = 2 * D * static_cast<Eigen::Index>(loaded.size());
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(rows, rows);
  for (std::size_t i = 0; i < loaded.size(); ++i)
    for (int end = 0; end < 2; ++end)
      for (int other = 0; other < 2; ++other)
        for (int c = 0; c < D; ++c)
          mass((2 * i + end) * D + c, (2 * i + other) * D + c) =
              mesh.length(loaded[i]) / (end == other ? 3 : 6);
  return mass;
}

/// The same for a traction on the loaded edges, and no load.
template <int D>
double constant_of_tractions(const Mesh& mesh, const std::vector<int>& loaded) {
  const LocalEquilibrium<D> stresses(mesh, loaded);
  const Eigen::MatrixXd balanced = Eigen::FullPivLU<Eigen::MatrixXd>(stresses.loads).kernel();
  const Eigen::Index rows = 2 * D * static_cast<Eigen::Index>(loaded.size());
  Eigen::MatrixXd linear = Eigen::MatrixXd::Zero(rows, 2 * D);
  const Point origin = mesh.points[mesh.edges[loaded[0]][0]];
  for (std::size_t i = 0; i < loaded.size(); ++i)
    for (int end = 0; end < 2; ++end) {
      const double place = (mesh.points[mesh.edges[loaded[i]][end]] - origin).norm();
      for (int c = 0; c < D; ++c) {
        const Eigen::Index row = (2 * i + end) * D + c;
        linear(row, c) = 1;
        linear(row, D + c) = place;
      }
    }
  return largest_least<D>(balanced.transpose() * stresses.energy * balanced, balanced.topRows(rows),
                          mass_of_tractions<D>(mesh, loaded), linear);
}

/// The rigid motions of linear functions, LocalEquilibrium::linear: of a membrane the constants.
template <int D>
Eigen::MatrixXd motions(const Eigen::MatrixXd& linear) {
  if constexpr (D == 1) return linear.leftCols(1);
  Eigen::MatrixXd all(linear.rows(), 3);
  all << linear.leftCols(2), linear.col(4) - linear.col(3);
  return all;
}

/// The largest norm of the least stress for a load of norm 1 that is orthogonal to rigid motions. What it has
/// beyond its linear part on each triangle is orthogonal there to linear functions.
template <int D>
double motion_constant_of_loads(const Mesh& mesh, double beyond) {
  const LocalEquilibrium<D> stresses(mesh);
  const Eigen::MatrixXd none(stresses.loads.rows(), 0);
  const double known = largest_least<D>(stresses.energy, stresses.loads, stresses.mass, none);
  return std::sqrt(known * known + beyond * beyond / 64);
}

/// The same for a traction of norm 1 on the loaded edges and the load that is a rigid motion and balances it.
template <int D>
double motion_constant_of_tractions(const Mesh& mesh, const std::vector<int>& loaded, double beyond) {
  const LocalEquilibrium<D> stresses(mesh, loaded);
  const Eigen::MatrixXd rigid = motions<D>(stresses.linear);
  const Eigen::MatrixXd onto_rigid =
      rigid * (rigid.transpose() * stresses.mass * rigid).inverse() * rigid.transpose() * stresses.mass;
  Eigen::FullPivLU<Eigen::MatrixXd> beyond_motions(stresses.loads - onto_rigid * stresses.loads);
  beyond_motions.setThreshold(1e-9);
  const Eigen::MatrixXd balanced = beyond_motions.kernel();
  const Eigen::Index rows = 2 * D * static_cast<Eigen::Index>(loaded.size());
  const Eigen::MatrixXd tractions = balanced.topRows(rows),
                        energy = balanced.transpose() * stresses.energy * balanced;
  const Eigen::MatrixXd mass = mass_of_tractions<D>(mesh, loaded);
  // The least energy for tractions x is xᵀ (T energy⁻¹ Tᵀ)⁻¹ x.
  const Eigen::MatrixXd pliancy = tractions * energy.ldlt().solve(tractions.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(pliancy.inverse(), mass,
                                                                        Eigen::EigenvaluesOnly);
  return std::sqrt(eigen.eigenvalues().maxCoeff() + beyond * beyond / 8);
}

template <int D>
void expect_constants(const ReferenceTriangle& reference) {
  const auto expect_just_below = [](double constant, double said) {
    EXPECT_LE(constant, said);
    EXPECT_GE(constant, 0.99 * said);
  };
  const ReferenceConstants& constants = reference.constants(D);
  const Mesh mesh = cut(reference.corners, 3);
  ASSERT_EQ(mesh.triangles.size(), 64u);
  expect_just_below(constant_of_loads<D>(mesh) / std::sqrt(1 - 1. / 64), constants.load);
  for (int e = 0; e < 3; ++e) {
    const std::vector<int>& edges = mesh.boundary[e].edges;
    ASSERT_EQ(edges.size(), 8u);
    expect_just_below(constant_of_tractions<D>(mesh, edges) / std::sqrt(1 - 1. / 8), constants.on_edges[e]);
    expect_just_below(motion_constant_of_tractions<D>(mesh, edges, constants.on_edges[e]),
                      constants.motion.on_edges[e]);
  }
  expect_just_below(motion_constant_of_loads<D>(mesh, constants.load), constants.motion.on_triangle);
}

TEST(LinearRemainder, OfTheReferenceTrianglesIsWhatTheyAreSaidToHave) {
  for (const ReferenceTriangle& reference : reference_triangles()) {
    expect_constants<1>(reference);
    expect_constants<2>(reference);
  }
}

TEST(LinearRemainder, IsThatOfTheReferenceTrianglesHoweverTheyLie) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (const ReferenceTriangle& reference : reference_triangles())
    for (int first = 0; first < 3; ++first) {
      std::array<Point, 3> corners;
      for (int z = 0; z < 3; ++z) {
        const Point& x = reference.corners[(first + z) % 3];
        corners[z] = 1e9 * Point(3 + c * x.x() - s * x.y(), s * x.x() + c * x.y());
      }
      const auto expect = [&]<int D>(std::integral_constant<int, D>) {
        const ReferenceConstants& constants = reference.constants(D);
        EXPECT_NEAR(linear_remainder<D>(corners), 1e9 * constants.load, 1e-6 * 1e9);
        const MotionRemainder motion = motion_remainder<D>(corners);
        EXPECT_NEAR(motion.on_triangle, 1e9 * constants.motion.on_triangle, 1e-6 * 1e9);
        for (int e = 0; e < 3; ++e) {
          const int there = (first + e) % 3;
          const double root = std::sqrt(1e9);
          EXPECT_NEAR(linear_remainder_on_edge<D>(corners, e), root * constants.on_edges[there], 1e-6 * root);
          EXPECT_NEAR(motion.on_edges[e], root * constants.motion.on_edges[there], 1e-6 * root);
        }
      };
      expect(std::integral_constant<int, 1>());
      expect(std::integral_constant<int, 2>());
    }
}

/// ‖w − p‖ / ‖ε(w)‖ of w = x², or (x², 0), where the least linear p is the projection.
TEST(LinearRemainder, IsNotLessThanThatOfAnExample) {
  for (const double height : {0.2, 1., 3.}) {
    const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0.3, height)};
    const AffineMap map(corners);
    const auto integral = [&](const auto& f) {
      double sum = 0;
      for (int q = 0; q < TriangleRule::size; ++q)
        sum += triangle_rule().weights[q] * map.determinant * f(triangle_rule().points[q]);
      return sum;
    };
    const auto square = [&](const Point& x) { return map(x).x() * map(x).x(); };
    Eigen::Vector3d moments;
    for (int z = 0; z < 3; ++z)
      moments[z] = integral([&](const Point& x) { return triangle_basis(1, x)[z] * square(x); });
    const Eigen::Vector3d projection = 24 / map.determinant * (moments.array() - moments.sum() / 4);
    const double rest = integral([&](const Point& x) {
      return std::pow(square(x) - projection.dot(Eigen::Vector3d(triangle_basis(1, x))), 2);
    });
    const double strain = integral([&](const Point& x) { return 4 * square(x); });
    EXPECT_GE(linear_remainder<1>(corners), std::sqrt(rest / strain)) << height;
    EXPECT_GE(linear_remainder<2>(corners), std::sqrt(rest / strain)) << height;
  }
}

}  // namespace
}  // namespace signorini::linear_remainder_test
