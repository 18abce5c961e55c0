#include "certify/data/local_equilibrium.hpp"

#include <array>
#include <utility>

#include <Eigen/LU>

#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "fem/couple.hpp"
#include "fem/lagrange.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

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
  Eigen::Matrix<double, JohnsonMercier::kData, kUnknowns> data = decltype(data)::Zero();
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
  load.rightCols<kMore>() = kernel(tested);
  for (int j = 0; j < kUnknowns; ++j)
    data.col(j).tail<12>() =
        (-map.determinant * inverse * at_nodes<2>(load.col(j).reshaped(2, 3))).reshaped();
  const JohnsonMercierRule& rule = johnson_mercier_rule(spaces_of(Scheme::nonconforming, 2), 6);
  const JohnsonMercierNorms norms(rule, map, SymmetricLaw(Eigen::Matrix4d::Identity()));
  const Eigen::MatrixXd root = norms.correction.leftCols<JohnsonMercier::kData>() * data;
  energy = root.transpose() * root;
}

}  // namespace

template <int D>
LocalEquilibrium<D>::LocalEquilibrium(const Mesh& mesh, const std::vector<int>& loaded) {
  std::vector<int> first(mesh.edges.size(), -1);
  int unknowns = 0;
  for (const int edge : loaded) first[edge] = std::exchange(unknowns, unknowns + 2 * D);
  for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
    if (mesh.edge_triangles[edge][1] >= 0) first[edge] = std::exchange(unknowns, unknowns + 2 * D);
  const int triangles = static_cast<int>(mesh.triangles.size()), tractions = unknowns;
  unknowns += triangles * LocalStress<D>::kMore;
  energy = Eigen::MatrixXd::Zero(unknowns, unknowns);
  loads = Eigen::MatrixXd::Zero(3 * D * triangles, unknowns);
  mass = Eigen::MatrixXd::Zero(loads.rows(), loads.rows());
  linear = Eigen::MatrixXd::Zero(loads.rows(), 3 * D);
  for (int t = 0; t < triangles; ++t) {
    const auto corners = mesh.corners(t);
    const LocalStress<D> own(corners);
    std::array<int, LocalStress<D>::kUnknowns> numbers;
    Eigen::Matrix<double, LocalStress<D>::kUnknowns, 1> signs = decltype(signs)::Ones();
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh.triangle_edges[t][e];
      for (int end = 0; end < 2; ++end) {
        const int point = mesh.triangles[t][(e + 1 + end) % 3];
        for (int c = 0; c < D; ++c) {
          const int j = (2 * e + end) * D + c;
          numbers[j] = first[edge] < 0 ? -1 : first[edge] + D * (point == mesh.edges[edge][1]) + c;
          signs[j] = mesh.edge_triangles[edge][0] == t ? 1 : -1;
        }
      }
    }
    for (int k = 0; k < LocalStress<D>::kMore; ++k)
      numbers[LocalStress<D>::kTractions + k] = tractions + t * LocalStress<D>::kMore + k;
    const int first_row = 3 * D * t;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] < 0) continue;
      loads.block<3 * D, 1>(first_row, numbers[i]) += signs[i] * own.load.col(i);
      for (std::size_t j = 0; j < numbers.size(); ++j)
        if (numbers[j] >= 0) energy(numbers[i], numbers[j]) += signs[i] * signs[j] * own.energy(i, j);
    }
    const double area = AffineMap(corners).determinant / 2;
    for (int z = 0; z < 3; ++z)
      for (int c = 0; c < D; ++c) {
        const int row = first_row + z * D + c;
        for (int y = 0; y < 3; ++y) mass(row, first_row + y * D + c) = area / (z == y ? 6 : 12);
        linear(row, c) = 1;
        linear.block<1, 2>(row, D + 2 * c) = corners[z].transpose();
      }
  }
}

template struct LocalEquilibrium<1>;
template struct LocalEquilibrium<2>;

}  // namespace signorini
