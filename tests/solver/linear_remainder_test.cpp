#include "certify/linear_remainder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "certify/macro_values.hpp"
#include "fem/couple.hpp"
#include "fem/lagrange.hpp"
#include "mesh/refine.hpp"

namespace signorini {
namespace {

/// The triangle cut into similar ones, four times as many each time. Part e of the boundary is its edge e.
Mesh cut(const std::array<Point, 3>& corners, int times) {
  return refine(make_mesh({corners.begin(), corners.end()}, {{0, 1, 2}}, {"0", "1", "2"},
                          {{{1, 2}, 0}, {{2, 0}, 1}, {{0, 1}, 2}}),
                times);
}

/// Stresses of compliance 1 on one triangle with linear tractions and a linear load: what they are for the
/// tractions (local edge, end, component) and a few more unknowns.
template <int D>
struct LocalStress {
  static constexpr int kTractions = 6 * D, kMore = D + 1, kUnknowns = kTractions + kMore;

  Eigen::Matrix<double, kUnknowns, kUnknowns> energy;
  Eigen::Matrix<double, 3 * D, kUnknowns> load;  ///< at the corners, the components of a corner together

  explicit LocalStress(const std::array<Point, 3>& corners);
};

/// RT1, whose two inner functions are the unknowns beyond the tractions.
template <>
LocalStress<1>::LocalStress(const std::array<Point, 3>& corners) {
  const RaviartThomas element(1);
  const AffineMap map(corners);
  Eigen::Matrix<double, 8, 8> coefficients = Eigen::Matrix<double, 8, 8>::Identity();
  for (int e = 0; e < 3; ++e) {
    const double length = (corners[(e + 2) % 3] - corners[(e + 1) % 3]).norm();
    coefficients.block<2, 2>(2 * e, 2 * e) << length / 3, length / 6, length / 6, length / 3;
  }
  energy.setZero();
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Eigen::MatrixXd values = element.values(map, triangle_rule().points[q]) * coefficients;
    energy += triangle_rule().weights[q] * map.determinant * values.transpose() * values;
  }
  const std::array<Point, 3> reference{Point(0, 0), Point(1, 0), Point(0, 1)};
  for (int z = 0; z < 3; ++z)
    load.row(z) = -element.reference_divergences(reference[z]).transpose() * coefficients / map.determinant;
}

/// The macro-element of the certificate. The unknowns beyond the tractions are the loads that have neither
/// force nor moment.
template <>
LocalStress<2>::LocalStress(const std::array<Point, 3>& corners) {
  const AffineMap map(corners);
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  const double area = map.determinant / 2;
  const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
  Eigen::Matrix<double, 6, 3> rigid;
  for (int z = 0; z < 3; ++z)
    rigid.middleRows<2>(2 * z) << 1, 0, turned_left(corners[z] - centroid).x(), 0, 1,
        turned_left(corners[z] - centroid).y();
  Eigen::Matrix<double, 6, 6> mass;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 3; ++y)
      mass.block<2, 2>(2 * z, 2 * y) = area / (z == y ? 6 : 12) * Eigen::Matrix2d::Identity();

  // The load of a traction is the rigid motion that balances it.
  Eigen::Matrix<double, MacroElement::kData, kUnknowns> data = decltype(data)::Zero();
  Eigen::Matrix<double, 3, kTractions> moments;
  for (int e = 0; e < 3; ++e) {
    const double length = (corners[(e + 2) % 3] - corners[(e + 1) % 3]).norm();
    for (int end = 0; end < 2; ++end) {
      const Vector here = corners[(e + 1 + end) % 3] - centroid,
                   there = corners[(e + 2 - end) % 3] - centroid;
      const Vector turning = turned_left(2 * here + there);
      const int first = 4 * e + 2 * end;
      moments.middleCols<2>(first) << length / 2, 0, 0, length / 2, length / 6 * turning.x(),
          length / 6 * turning.y();
      data.block<2, 2>(6 * e + 2 * end, first) = length * inverse;
      data.block<2, 2>(6 * e + 4, first) = length / 2 * inverse;
    }
  }
  const Eigen::Matrix<double, 3, 6> tested = rigid.transpose() * mass;
  load.leftCols<kTractions>() = -rigid * (tested * rigid).inverse() * moments;
  load.rightCols<kMore>() = Eigen::FullPivLU<Eigen::MatrixXd>(tested).kernel();
  for (int j = 0; j < kUnknowns; ++j)
    data.col(j).tail<12>() =
        (-map.determinant * inverse * at_nodes<2>(load.col(j).reshaped(2, 3))).reshaped();
  const MacroRule& rule = macro_rule(spaces_of(Scheme::nonconforming, 2), 6);
  const MacroNorms norms(rule, map, SymmetricLaw(Eigen::Matrix4d::Identity()));
  const Eigen::MatrixXd root = norms.correction.leftCols<MacroElement::kData>() * data;
  energy = root.transpose() * root;
}

/// The stresses on a mesh. The unknowns are the tractions at both ends of the loaded edges, then those of the
/// edges inside, then what the triangles have more.
template <int D>
class Equilibrium {
 public:
  explicit Equilibrium(const Mesh& mesh, const std::vector<int>& loaded = {})
      : mesh_(mesh), loaded_(loaded), first_(mesh.edges.size(), -1) {
    for (const int edge : loaded) first_[edge] = std::exchange(unknowns_, unknowns_ + 2 * D);
    for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
      if (mesh.edge_triangles[edge][1] >= 0) first_[edge] = std::exchange(unknowns_, unknowns_ + 2 * D);
    const int triangles = static_cast<int>(mesh.triangles.size()), tractions = unknowns_;
    unknowns_ += triangles * LocalStress<D>::kMore;
    energy_ = Eigen::MatrixXd::Zero(unknowns_, unknowns_);
    loads_ = Eigen::MatrixXd::Zero(3 * D * triangles, unknowns_);
    mass_ = Eigen::MatrixXd::Zero(loads_.rows(), loads_.rows());
    linear_ = Eigen::MatrixXd::Zero(loads_.rows(), 3 * D);
    for (int t = 0; t < triangles; ++t) add(t, tractions + t * LocalStress<D>::kMore);
  }

  /// The largest norm of the least stress for a load of norm 1 that is orthogonal to the linear ones, without
  /// traction on the boundary.
  double constant_of_loads() const { return largest_least(energy_, loads_, mass_, linear_); }

  /// The same for a traction on the loaded edges, and no load.
  double constant_of_tractions() const {
    const Eigen::MatrixXd balanced = Eigen::FullPivLU<Eigen::MatrixXd>(loads_).kernel();
    const Eigen::Index rows = 2 * D * static_cast<Eigen::Index>(loaded_.size());
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(rows, rows), linear = Eigen::MatrixXd::Zero(rows, 2 * D);
    const Point origin = mesh_.points[mesh_.edges[loaded_[0]][0]];
    for (std::size_t i = 0; i < loaded_.size(); ++i)
      for (int end = 0; end < 2; ++end) {
        const double place = (mesh_.points[mesh_.edges[loaded_[i]][end]] - origin).norm();
        for (int c = 0; c < D; ++c) {
          const Eigen::Index row = (2 * i + end) * D + c;
          for (int other = 0; other < 2; ++other)
            mass(row, (2 * i + other) * D + c) = mesh_.length(loaded_[i]) / (end == other ? 3 : 6);
          linear(row, c) = 1;
          linear(row, D + c) = place;
        }
      }
    return largest_least(balanced.transpose() * energy_ * balanced, balanced.topRows(rows), mass, linear);
  }

 private:
  /// max over x of min zᵀ energy z, over z with loads z = x, xᵀ mass x = 1 and xᵀ mass linear = 0; its root.
  static double largest_least(const Eigen::MatrixXd& energy, const Eigen::MatrixXd& loads,
                              const Eigen::MatrixXd& mass, const Eigen::MatrixXd& linear) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(loads.transpose());
    const Eigen::Index rank = qr.rank(), rest = loads.cols() - rank;
    EXPECT_EQ(rank, loads.rows() - (D == 1 ? 1 : 3));  // all but the rigid motions of the whole
    const Eigen::MatrixXd q = qr.householderQ();
    const Eigen::MatrixXd idle = q.rightCols(rest), x_of = loads * q.leftCols(rank);
    Eigen::FullPivLU<Eigen::MatrixXd> tested(linear.transpose() * mass * x_of);
    tested.setThreshold(1e-9);  // the loads have no rigid motion already, but for rounding
    const Eigen::MatrixXd orthogonal = tested.kernel();
    EXPECT_EQ(orthogonal.cols(), loads.rows() - linear.cols());
    const Eigen::MatrixXd loading = q.leftCols(rank) * orthogonal, x = x_of * orthogonal;
    const Eigen::MatrixXd own = idle.transpose() * energy * idle, mixed = idle.transpose() * energy * loading;
    const Eigen::MatrixXd least =
        loading.transpose() * energy * loading - mixed.transpose() * own.ldlt().solve(mixed);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(least, x.transpose() * mass * x,
                                                                          Eigen::EigenvaluesOnly);
    return std::sqrt(eigen.eigenvalues().maxCoeff());
  }

  void add(int t, int more) {
    const auto corners = mesh_.corners(t);
    const LocalStress<D> own(corners);
    std::array<int, LocalStress<D>::kUnknowns> numbers;
    Eigen::Matrix<double, LocalStress<D>::kUnknowns, 1> signs = decltype(signs)::Ones();
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh_.triangle_edges[t][e];
      for (int end = 0; end < 2; ++end) {
        const int point = mesh_.triangles[t][(e + 1 + end) % 3];
        for (int c = 0; c < D; ++c) {
          const int j = (2 * e + end) * D + c;
          numbers[j] = first_[edge] < 0 ? -1 : first_[edge] + D * (point == mesh_.edges[edge][1]) + c;
          signs[j] = mesh_.edge_triangles[edge][0] == t ? 1 : -1;
        }
      }
    }
    for (int k = 0; k < LocalStress<D>::kMore; ++k) numbers[LocalStress<D>::kTractions + k] = more + k;
    const int first_row = 3 * D * t;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] < 0) continue;
      loads_.block<3 * D, 1>(first_row, numbers[i]) += signs[i] * own.load.col(i);
      for (std::size_t j = 0; j < numbers.size(); ++j)
        if (numbers[j] >= 0) energy_(numbers[i], numbers[j]) += signs[i] * signs[j] * own.energy(i, j);
    }
    const double area = AffineMap(corners).determinant / 2;
    for (int z = 0; z < 3; ++z)
      for (int c = 0; c < D; ++c) {
        const int row = first_row + z * D + c;
        for (int y = 0; y < 3; ++y) mass_(row, first_row + y * D + c) = area / (z == y ? 6 : 12);
        linear_(row, c) = 1;
        linear_.block<1, 2>(row, D + 2 * c) = corners[z].transpose();
      }
  }

  const Mesh& mesh_;
  const std::vector<int> loaded_;
  std::vector<int> first_;
  int unknowns_ = 0;
  Eigen::MatrixXd energy_, loads_, mass_, linear_;
};

template <int D>
void expect_constants(const ReferenceTriangle& reference) {
  const auto expect_just_below = [](double constant, double said) {
    EXPECT_LE(constant, said);
    EXPECT_GE(constant, 0.99 * said);
  };
  const ReferenceConstants& constants = reference.constants(D);
  const Mesh mesh = cut(reference.corners, 3);
  ASSERT_EQ(mesh.triangles.size(), 64u);
  expect_just_below(Equilibrium<D>(mesh).constant_of_loads() / std::sqrt(1 - 1. / 64), constants.load);
  for (int e = 0; e < 3; ++e) {
    const std::vector<int>& edges = mesh.boundary[e].edges;
    ASSERT_EQ(edges.size(), 8u);
    expect_just_below(Equilibrium<D>(mesh, edges).constant_of_tractions() / std::sqrt(1 - 1. / 8),
                      constants.on_edges[e]);
  }
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
        for (int e = 0; e < 3; ++e)
          EXPECT_NEAR(linear_remainder_on_edge<D>(corners, e),
                      std::sqrt(1e9) * constants.on_edges[(first + e) % 3], 1e-6 * std::sqrt(1e9));
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
}  // namespace signorini
