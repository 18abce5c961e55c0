#include "certify/membrane/quadratic_balance.hpp"

#include "certify/data/balanced_load.hpp"
#include "fem/lagrange.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

/// Below this part of what there is, what lacks is rounding.
constexpr double kBalanceRounding = 1e-14;

constexpr int kBalanceData = QuadraticBalance::kData, kFluxes = QuadraticBalance::kFluxes;
using BalanceValues = QuadraticBalance::Values;

/// RT2 = P2² + x P̃2: two times the basis of P2, and x times x², xy, y².
BalanceValues functions(const Point& x) {
  const Eigen::Matrix<double, 6, 1> basis = quadratic_basis(x);
  BalanceValues values = BalanceValues::Zero();
  for (int j = 0; j < 6; ++j) values.block<2, 2>(0, 2 * j) = basis[j] * Eigen::Matrix2d::Identity();
  values.rightCols<3>() << x * x.x() * x.x(), x * x.x() * x.y(), x * x.y() * x.y();
  return values;
}

Eigen::Matrix<double, 1, kBalanceData> divergences(const Point& x) {
  Eigen::Matrix<double, 1, kBalanceData> values;
  values << quadratic_gradients(x).reshaped().transpose(), 4 * x.x() * x.x(), 4 * x.x() * x.y(),
      4 * x.y() * x.y();
  return values;
}

/// The curl of λ₀ λ₁ λ₂.
Vector curl_of_bubble(const Point& x) {
  const double l1 = x.x(), l2 = x.y(), l0 = 1 - l1 - l2;
  return {l1 * (l0 - l2), -l2 * (l0 - l1)};
}

/// Column j: the coefficients of the function with datum j.
Eigen::Matrix<double, kBalanceData, kBalanceData> functions_of_data() {
  const std::array<Point, 6> nodes{Point(0, 0),     Point(1, 0),   Point(0, 1),
                                   Point(0.5, 0.5), Point(0, 0.5), Point(0.5, 0)};
  Eigen::Matrix<double, kBalanceData + 1, kBalanceData> data = decltype(data)::Zero();
  for (int e = 0; e < 3; ++e) {
    const int a = (e + 1) % 3, b = (e + 2) % 3;
    const Vector way = nodes[b] - nodes[a], normal(way.y(), -way.x());
    const std::array<int, 3> on_edge{a, b, 3 + e};
    for (int i = 0; i < 3; ++i) data.row(3 * e + i) = normal.transpose() * functions(nodes[on_edge[i]]);
  }
  for (int j = 0; j < 6; ++j) data.row(kFluxes + j) = divergences(nodes[j]);
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point& x = triangle_rule().points[q];
    data.bottomRows<1>() += triangle_rule().weights[q] * curl_of_bubble(x).transpose() * functions(x);
  }
  return least_squares(data, Eigen::MatrixXd::Identity(data.rows(), data.cols()));
}

}  // namespace

bool QuadraticBalance::is_needed() const {
  for (int edge = 0; edge < static_cast<int>(discrete_.mesh.edges.size()); ++edge)
    if (discrete_.traction.acts_on(edge) && !lacking_on(edge).isZero(0)) return true;
  if (!discrete_.body.varies()) return false;
  const ProjectedLoad* constant = nullptr;  // most triangles share theirs with the one before
  for (int t = 0; t < discrete_.triangles(); ++t) {
    const ProjectedLoad& own = discrete_.body[t];
    if (&own == constant) continue;
    if ((own.balanced.colwise() - own.balanced.col(0)).isZero(0))
      constant = &own;
    else if ((*this)(t))
      return true;
  }
  return false;
}

Eigen::Vector3d QuadraticBalance::lacking_on(int edge) const {
  const auto own = [&](double s) { return discrete_.traction(edge, 0, s); };
  const Eigen::Vector3d all = projection_at_nodes(2, own),
                        lacking = all - projection_at_nodes(discrete_.spaces().order, own);
  return lacking.norm() <= kBalanceRounding * all.norm() ? Eigen::Vector3d::Zero() : lacking;
}

std::optional<QuadraticBalance::Data> QuadraticBalance::operator()(int t) const {
  const int order = discrete_.spaces().order;
  const Mesh& mesh = discrete_.mesh;
  const Quadratic<1> balanced = balanced_load<1>(discrete_, t);
  const double twice_area = AffineMap(mesh.corners(t)).determinant;
  Quadratic<1> lacking = balanced;
  if (order == 0)
    lacking.array() -= balanced.rightCols<3>().mean();
  else
    lacking -= at_nodes<1>(discrete_load<1>(discrete_, t));
  if (lacking.norm() <= kBalanceRounding * balanced.norm()) lacking.setZero();
  Data data = Data::Zero();
  data.tail<6>() = -twice_area * lacking.transpose();
  for (int e = 0; e < 3; ++e) {
    const int edge = mesh.triangle_edges[t][e];
    if (!discrete_.traction.acts_on(edge)) continue;
    Eigen::Vector3d own = mesh.length(edge) * lacking_on(edge);
    if (mesh.triangles[t][(e + 1) % 3] != mesh.edges[edge][0]) std::swap(own[0], own[1]);
    data.segment<3>(3 * e) = own;
  }
  if (data.isZero(0)) return std::nullopt;
  return data;
}

QuadraticBalance::Values QuadraticBalance::reference_values(const Point& reference) {
  static const Eigen::Matrix<double, kBalanceData, kBalanceData> of_data = functions_of_data();
  return functions(reference).lazyProduct(of_data);
}

StressAtPoints QuadraticBalance::at_points(const AffineMap& map, const Data& data) {
  static const auto values = [] {
    std::array<BalanceValues, TriangleRule::size> all;
    for (int q = 0; q < TriangleRule::size; ++q) all[q] = reference_values(triangle_rule().points[q]);
    return all;
  }();
  StressAtPoints tau;
  for (int q = 0; q < TriangleRule::size; ++q)
    tau.col(q) = map.jacobian * values[q].lazyProduct(data) / map.determinant;
  return tau;
}

}  // namespace signorini
