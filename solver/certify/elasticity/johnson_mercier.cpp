#include "certify/elasticity/johnson_mercier.hpp"

#include <cmath>

#include <Eigen/LU>

#include "fem/small_matrices.hpp"
#include "fem/triangle_pieces.hpp"

namespace signorini {
namespace {

using DynamicMatrix = Eigen::MatrixXd;

Point corner(int i) {
  static const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  return corners[i % 3];
}

const Point kCentroid(1. / 3, 1. / 3);

/// The affine map of a part: from its corners, those of the edge first and then the centroid.
struct JohnsonMercierPart {
  explicit JohnsonMercierPart(int k) : origin(corner(k + 1)) {
    jacobian << corner(k + 2) - origin, kCentroid - origin;
  }

  Point operator()(const Point& own) const { return origin + jacobian * own; }

  Point origin;
  Eigen::Matrix2d jacobian;
};

/// The numbers of a part's six nodes among the ten: corners, then the middles opposite to them.
std::array<int, 6> nodes_of(int part) {
  const int a = (part + 1) % 3, b = (part + 2) % 3;
  return {a, b, 6, 7 + b, 7 + a, 3 + part};
}

/// The reference coordinates of a part's nodes in the part.
Point own_node(int i) {
  static const std::array<Point, 6> nodes{Point(0, 0),     Point(1, 0),   Point(0, 1),
                                          Point(0.5, 0.5), Point(0, 0.5), Point(0.5, 0)};
  return nodes[i];
}

/// The normal to the right of the way from a to b, as long as the way.
Vector scaled_normal(const Point& a, const Point& b) {
  return {b.y() - a.y(), a.x() - b.x()};
}

/// λ₀, λ₁, λ₂, and their gradients by columns.
Eigen::Vector3d barycentric(const Point& x) {
  return {1 - x.x() - x.y(), x.x(), x.y()};
}
Eigen::Matrix<double, 2, 3> barycentric_gradients() {
  return (Eigen::Matrix<double, 2, 3>() << -1, 1, 0, -1, 0, 1).finished();
}

Eigen::Matrix<double, 3, JohnsonMercier::kBubbles> bubbles(const Point& x) {
  const Eigen::Vector3d lambda = barycentric(x);
  Eigen::Matrix<double, 3, JohnsonMercier::kBubbles> values;
  for (int e = 0; e < 3; ++e) {
    const int i = (e + 1) % 3, j = (e + 2) % 3;
    const Vector t = corner(j) - corner(i);
    for (const auto& [k, m] : {std::pair(0, i), {1, j}})
      values.col(2 * e + k) =
          lambda[i] * lambda[j] * lambda[m] * Eigen::Vector3d(t.x() * t.x(), t.y() * t.y(), t.x() * t.y());
  }
  return values;
}

Eigen::Matrix<double, 2, JohnsonMercier::kBubbles> divergences_of_bubbles(const Point& x) {
  const Eigen::Vector3d lambda = barycentric(x);
  const Eigen::Matrix<double, 2, 3> slopes = barycentric_gradients();
  Eigen::Matrix<double, 2, JohnsonMercier::kBubbles> values;
  for (int e = 0; e < 3; ++e) {
    const int i = (e + 1) % 3, j = (e + 2) % 3;
    const Vector t = corner(j) - corner(i);
    for (const auto& [k, m] : {std::pair(0, i), {1, j}})
      values.col(2 * e + k) =
          t * t.dot(lambda[j] * lambda[m] * slopes.col(i) + lambda[i] * lambda[m] * slopes.col(j) +
                    lambda[i] * lambda[j] * slopes.col(m));
  }
  return values;
}

/// Rows of conditions on the coefficients and the data that they must meet.
struct JohnsonMercierConditions {
  static constexpr int kRows = 18 + 18 + 36;
  DynamicMatrix of_stress = DynamicMatrix::Zero(kRows, JohnsonMercier::kStresses);
  DynamicMatrix of_data = DynamicMatrix::Zero(kRows, JohnsonMercier::kData);
  int rows = 0;

  /// Adds τ N at node i of a part to two rows.
  void add_traction(int row, int part, int i, const Vector& n, double sign) {
    const int first = 18 * part + 3 * i;
    of_stress.block<2, 3>(row, first) +=
        sign * (Eigen::Matrix<double, 2, 3>() << n.x(), 0, n.y(), 0, n.y(), n.x()).finished();
  }
};

void add_outer_tractions(JohnsonMercierConditions& all) {
  for (int k = 0; k < 3; ++k) {
    const Vector n = scaled_normal(corner(k + 1), corner(k + 2));
    const std::array<int, 3> nodes{0, 1, 5};
    for (int i = 0; i < 3; ++i, all.rows += 2) {
      all.add_traction(all.rows, k, nodes[i], n, 1);
      all.of_data.block<2, 2>(all.rows, 6 * k + 2 * i).setIdentity();
    }
  }
}

void add_inner_continuity(JohnsonMercierConditions& all) {
  for (int v = 0; v < 3; ++v) {
    const Vector n = scaled_normal(corner(v), kCentroid);
    // Corner v begins the edge of one part and ends that of another.
    const int begins = (v + 2) % 3, ends = (v + 1) % 3;
    for (const auto& [first, second] : {std::pair{0, 1}, {2, 2}, {4, 3}}) {
      all.add_traction(all.rows, begins, first, n, 1);
      all.add_traction(all.rows, ends, second, n, -1);
      all.rows += 2;
    }
  }
}

void add_divergence(JohnsonMercierConditions& all) {
  for (int k = 0; k < 3; ++k) {
    const JohnsonMercierPart part(k);
    const DynamicMatrix to_reference = part.jacobian.inverse().transpose();
    for (int i = 0; i < 6; ++i, all.rows += 2) {
      const Point x = part(own_node(i));
      const DynamicMatrix gradients = to_reference * quadratic_gradients(own_node(i));
      for (int j = 0; j < 6; ++j) {
        const Vector g = gradients.col(j);
        all.of_stress.block<2, 3>(all.rows, 18 * k + 3 * j) << g.x(), 0, g.y(), 0, g.y(), g.x();
      }
      all.of_stress.block<2, JohnsonMercier::kBubbles>(all.rows, JohnsonMercier::kPieces) =
          divergences_of_bubbles(x);
      const Eigen::Matrix<double, 6, 1> shares = quadratic_basis(x);
      for (int j = 0; j < 6; ++j)
        all.of_data.block<2, 2>(all.rows, JohnsonMercier::kTractions + 2 * j) =
            shares[j] * Eigen::Matrix2d::Identity();
    }
  }
}

JohnsonMercier make() {
  JohnsonMercierConditions all;
  add_outer_tractions(all);
  add_inner_continuity(all);
  add_divergence(all);
  constexpr double smallest_pivot = 1e-10;  // some conditions say what others say
  JohnsonMercier element;
  element.from_data = shortest_least_squares(all.of_stress, all.of_data, smallest_pivot);
  element.free = kernel(all.of_stress, smallest_pivot);
  return element;
}

}  // namespace

Eigen::Vector3d JohnsonMercier::stress(
    const Place& place, const Eigen::Ref<const Eigen::Vector<double, kStresses>>& coefficients) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 6>> pieces(coefficients.data() + 18 * place.part);
  return pieces * place.piece_basis + place.bubbles * coefficients.tail<kBubbles>();
}

Point JohnsonMercier::node(int number) {
  if (number < 3) return corner(number);
  if (number < 6) return (corner(number - 2) + corner(number - 1)) / 2;
  if (number == 6) return kCentroid;
  return (corner(number - 7) + kCentroid) / 2;
}

namespace {

/// At a point in the reference coordinates of part k.
JohnsonMercier::Place place_in(int k, const Point& own, double weight) {
  const JohnsonMercierPart part(k);
  JohnsonMercier::Place place{part(own),
                              weight,
                              k,
                              quadratic_basis(own),
                              bubbles(part(own)),
                              Eigen::Matrix<double, 2, JohnsonMercier::kNodes>::Zero(),
                              Eigen::Matrix<double, JohnsonMercier::kNodes, 1>::Zero()};
  const Eigen::Matrix<double, 2, 6> gradients =
      part.jacobian.inverse().transpose() * quadratic_gradients(own);
  const std::array<int, 6> nodes = nodes_of(k);
  for (int i = 0; i < 6; ++i) {
    place.displacement_gradients.col(nodes[i]) = gradients.col(i);
    place.displacement_basis[nodes[i]] = place.piece_basis[i];
  }
  return place;
}

}  // namespace

std::vector<JohnsonMercier::Place> JohnsonMercier::places(const std::vector<WeightedPoint>& rule) {
  std::vector<Place> all;
  for (int k = 0; k < 3; ++k)
    for (const auto& [point, weight] : rule) all.push_back(place_in(k, point, weight / 3));
  return all;
}

std::vector<JohnsonMercier::Place> JohnsonMercier::places(const std::vector<WeightedPoint>& rule,
                                                          const std::array<Point, 3>& triangle) {
  std::vector<Place> all;
  for (int k = 0; k < 3; ++k) {
    const JohnsonMercierPart part(k);
    const Eigen::Matrix2d into = part.jacobian.inverse();
    std::vector<Point> inside;
    for (const Point& x : triangle) inside.push_back(into * (x - part.origin));
    for (int side = 0; side < 3; ++side)
      inside = clip(inside, [&](const Point& own) { return barycentric(own)[side]; });
    for (std::size_t i = 2; i < inside.size(); ++i) {
      const Vector one = inside[i - 1] - inside[0], other = inside[i] - inside[0];
      const double share = std::abs(one.x() * other.y() - one.y() * other.x());
      for (const auto& [point, weight] : rule)
        all.push_back(place_in(k, inside[0] + point.x() * one + point.y() * other, share * weight / 3));
    }
  }
  return all;
}

const JohnsonMercier& johnson_mercier() {
  static const JohnsonMercier element = make();
  return element;
}

}  // namespace signorini
