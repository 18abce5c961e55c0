#include "certify/rigid_remainder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "certify/macro_values.hpp"
#include "fem/couple.hpp"
#include "mesh/refine.hpp"

namespace signorini {
namespace {

/// The triangle cut into similar ones, four times as many each time. Part e of the boundary is its edge e.
Mesh cut(const std::array<Point, 3>& corners, int times) {
  return refine(make_mesh({corners.begin(), corners.end()}, {{0, 1, 2}}, {"0", "1", "2"},
                          {{{1, 2}, 0}, {{2, 0}, 1}, {{0, 1}, 2}}),
                times);
}

/// Stresses on the macro-elements of the certificate. The unknowns are the tractions at both ends of the
/// edges inside and of the loaded edges; the load, a rigid motion on each triangle, is what balances them.
class Equilibrium {
 public:
  explicit Equilibrium(const Mesh& mesh, const std::vector<int>& loaded = {})
      : mesh_(mesh), first_(mesh.edges.size(), -1) {
    for (const int edge : loaded) first_[edge] = std::exchange(unknowns_, unknowns_ + 4);
    for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
      if (mesh.edge_triangles[edge][1] >= 0) first_[edge] = std::exchange(unknowns_, unknowns_ + 4);
    const int triangles = static_cast<int>(mesh.triangles.size());
    energy_ = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
    forces_ = Eigen::MatrixXd::Zero(3 * triangles, unknowns_);
    mass_.resize(3 * triangles);
    for (int t = 0; t < triangles; ++t) add(t);
  }

  /// The largest norm of the least stress for a load of norm 1, without traction on the boundary.
  double constant_of_loads() const {
    return largest_least(energy_, forces_, mass_.cwiseInverse().asDiagonal());
  }

  /// The same for a traction of norm 1 on the first edges, which are the loaded ones, and no load.
  double constant_of_tractions(int edges) const {
    const Eigen::MatrixXd balanced = Eigen::FullPivLU<Eigen::MatrixXd>(forces_).kernel();
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(4 * edges, 4 * edges);
    for (int edge = 0; edge < edges; ++edge)
      for (int i = 0; i < 4; ++i)
        for (int j = i % 2; j < 4; j += 2)
          mass(4 * edge + i, 4 * edge + j) = mesh_.length(edge_of(edge)) / (i == j ? 3 : 6);
    return largest_least(balanced.transpose() * energy_ * balanced, balanced.topRows(4 * edges), mass);
  }

 private:
  /// max over x of min zᵀ energy z, over z with loads z = x and xᵀ mass x = 1; its root.
  static double largest_least(const Eigen::MatrixXd& energy, const Eigen::MatrixXd& loads,
                              const Eigen::MatrixXd& mass) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(loads.transpose());
    const Eigen::Index rank = qr.rank(), rest = loads.cols() - rank;
    EXPECT_EQ(rank, loads.rows() - 3);  // all but the rigid motions of the whole
    const Eigen::MatrixXd q = qr.householderQ();
    const Eigen::MatrixXd loading = q.leftCols(rank), idle = q.rightCols(rest), h = energy * q;
    const Eigen::MatrixXd own = idle.transpose() * h.rightCols(rest);
    const Eigen::MatrixXd mixed = idle.transpose() * h.leftCols(rank);
    const Eigen::MatrixXd least =
        loading.transpose() * h.leftCols(rank) - mixed.transpose() * own.ldlt().solve(mixed);
    const Eigen::MatrixXd x = loads * loading;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(least, x.transpose() * mass * x,
                                                                          Eigen::EigenvaluesOnly);
    return std::sqrt(eigen.eigenvalues().maxCoeff());
  }

  int edge_of(int loaded) const {
    return static_cast<int>(std::find(first_.begin(), first_.end(), 4 * loaded) - first_.begin());
  }

  using Data = Eigen::Matrix<double, MacroElement::kData, Eigen::Dynamic>;

  void add(int t) {
    const auto corners = mesh_.corners(t);
    const AffineMap map(corners);
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    const double area = map.determinant / 2;
    // Moments of the tractions with the rigid motions, the third about the centroid.
    Eigen::Matrix<double, 3, 12> moments = Eigen::Matrix<double, 3, 12>::Zero();
    Data data = Data::Zero(MacroElement::kData, 12);
    std::array<int, 12> numbers;
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh_.triangle_edges[t][e];
      const double sign = mesh_.edge_triangles[edge][0] == t ? 1 : -1, length = mesh_.length(edge);
      for (int end = 0; end < 2; ++end) {
        const int point = mesh_.triangles[t][(e + 1 + end) % 3];
        const Vector here = corners[(e + 1 + end) % 3] - mesh_.centroid(t),
                     there = corners[(e + 2 - end) % 3] - mesh_.centroid(t);
        const Vector turning = turned_left(2 * here + there);
        const int first = 4 * e + 2 * end;
        for (int c = 0; c < 2; ++c) {
          numbers[first + c] = first_[edge] < 0 ? -1 : first_[edge] + 2 * (point == mesh_.edges[edge][1]) + c;
          moments(c, first + c) = sign * length / 2;
          moments(2, first + c) = sign * length / 6 * turning[c];
          data.col(first + c).segment<2>(first) = sign * length * inverse.col(c);
        }
      }
    }
    // The load that balances them; its values at the corners.
    Eigen::Matrix<double, 2, 3> arms;
    for (int z = 0; z < 3; ++z) arms.col(z) = turned_left(corners[z] - mesh_.centroid(t));
    const Eigen::Vector3d mass(area, area, area / 12 * arms.squaredNorm());
    for (int j = 0; j < 12; ++j) {
      const Eigen::Vector3d load = -mass.cwiseInverse().cwiseProduct(moments.col(j));
      const Eigen::Matrix<double, 2, 3> at_corners = load.head<2>().replicate<1, 3>() + load[2] * arms;
      data.col(j).tail<6>() = (-map.determinant * inverse * at_corners).reshaped();
    }
    static const MacroRule rule(spaces_of(Scheme::nonconforming, 2), 1);
    const MacroNorms norms(rule, map, SymmetricLaw(Eigen::Matrix4d::Identity()));
    const Eigen::MatrixXd root =
        norms.correction.leftCols<MacroElement::kData>() * data;  // upper triangular in full
    const Eigen::MatrixXd own = root.transpose() * root;
    mass_.segment<3>(3 * t) = mass;
    for (int i = 0; i < 12; ++i) {
      if (numbers[i] < 0) continue;
      forces_.block<3, 1>(3 * t, numbers[i]) += moments.col(i);
      for (int j = 0; j < 12; ++j)
        if (numbers[j] >= 0) energy_(numbers[i], numbers[j]) += own(i, j);
    }
  }

  const Mesh& mesh_;
  std::vector<int> first_;
  int unknowns_ = 0;
  Eigen::MatrixXd energy_, forces_;
  Eigen::VectorXd mass_;
};

TEST(RigidRemainder, OfTheReferenceTrianglesIsWhatTheyAreSaidToHave) {
  const auto expect_just_below = [](double constant, double said) {
    EXPECT_LE(constant, said);
    EXPECT_GE(constant, 0.99 * said);
  };
  for (const ReferenceTriangle& reference : reference_triangles()) {
    const Mesh mesh = cut(reference.corners, 3);
    ASSERT_EQ(mesh.triangles.size(), 64u);
    expect_just_below(Equilibrium(mesh).constant_of_loads() / std::sqrt(1 - 1. / 64), reference.constant);
    for (int e = 0; e < 3; ++e) {
      const std::vector<int>& edges = mesh.boundary[e].edges;
      ASSERT_EQ(edges.size(), 8u);
      expect_just_below(Equilibrium(mesh, edges).constant_of_tractions(8) / std::sqrt(1 - 1. / 8),
                        reference.on_edges[e]);
    }
  }
}

TEST(RigidRemainder, IsThatOfTheReferenceTrianglesHoweverTheyLie) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (const ReferenceTriangle& reference : reference_triangles())
    for (int first = 0; first < 3; ++first) {
      std::array<Point, 3> corners;
      for (int z = 0; z < 3; ++z) {
        const Point& x = reference.corners[(first + z) % 3];
        corners[z] = 1e9 * Point(3 + c * x.x() - s * x.y(), s * x.x() + c * x.y());
      }
      EXPECT_NEAR(rigid_remainder(corners), 1e9 * reference.constant, 1e-6 * 1e9);
      for (int e = 0; e < 3; ++e)
        EXPECT_NEAR(rigid_remainder_on_edge(corners, e), std::sqrt(1e9) * reference.on_edges[(first + e) % 3],
                    1e-6 * std::sqrt(1e9));
    }
}

/// ‖w − r‖ / ‖ε(w)‖ of w = (x², 0), where the least r has the moments of w.
TEST(RigidRemainder, IsNotLessThanThatOfAnExample) {
  for (const double height : {0.2, 1., 3.}) {
    const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0.3, height)};
    const AffineMap map(corners);
    const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
    const auto integral = [&](const auto& f) {
      double sum = 0;
      for (int q = 0; q < TriangleRule::size; ++q)
        sum += triangle_rule().weights[q] * map.determinant * f(map(triangle_rule().points[q]));
      return sum;
    };
    const double area = map.determinant / 2;
    const double mean = integral([](const Point& x) { return x.x() * x.x(); }) / area;
    const double turn = integral([&](const Point& x) { return -(x.y() - centroid.y()) * x.x() * x.x(); }) /
                        integral([&](const Point& x) { return (x - centroid).squaredNorm(); });
    const double rest = integral([&](const Point& x) {
      return (Vector(x.x() * x.x() - mean, 0) - turn * turned_left(x - centroid)).squaredNorm();
    });
    const double strain = integral([](const Point& x) { return 4 * x.x() * x.x(); });
    EXPECT_GE(rigid_remainder(corners), std::sqrt(rest / strain)) << height;
  }
}

}  // namespace
}  // namespace signorini
