#include "certify/relaxation.hpp"

#include <Eigen/LU>

#include "certify/load_values.hpp"
#include "certify/local_fields.hpp"
#include "certify/tensor.hpp"
#include "fem/lagrange.hpp"
#include "fem/traction_field.hpp"

namespace signorini {
namespace {

constexpr int kSteps = 3;

using Local = Eigen::Matrix<double, 6, 1>;
using LocalSquare = Eigen::Matrix<double, 6, 6>;

/// The integrals over the reference triangle of products of the six functions' derivatives, and of the
/// functions with the three hats.
struct Reference {
  Reference() {
    for (int q = 0; q < TriangleRule::size; ++q) {
      const Point& x = triangle_rule().points[q];
      const double weight = triangle_rule().weights[q];
      const Eigen::Matrix<double, 2, 6> slope = quadratic_gradients(x);
      xx += weight * slope.row(0).transpose() * slope.row(0);
      xy += weight * (slope.row(0).transpose() * slope.row(1) + slope.row(1).transpose() * slope.row(0));
      yy += weight * slope.row(1).transpose() * slope.row(1);
      hats += weight * quadratic_basis(x) * triangle_basis(1, x).transpose();
    }
  }

  LocalSquare xx = LocalSquare::Zero(), xy = LocalSquare::Zero(), yy = LocalSquare::Zero();
  Eigen::Matrix<double, 6, 3> hats = Eigen::Matrix<double, 6, 3>::Zero();
};

/// The energy ½ ‖∇v‖²_E − (Πf, v) − <t, v> as a function of the values at the points and in the middles of
/// the edges, which follow them.
class Energy {
 public:
  explicit Energy(const Discretization& problem)
      : problem_(problem),
        points_(static_cast<int>(problem.mesh.points.size())),
        moduli_(3, problem.triangles()) {
    LawField<1> law(problem.problem.material);
    for (int t = 0; t < problem.triangles(); ++t) {
      const AffineMap map(problem.mesh.corners(t));
      const Eigen::Matrix2d inverse = map.jacobian.inverse();
      const Eigen::Matrix2d e =
          map.determinant * inverse * law(problem.mesh.centroid(t)).stiffness * inverse.transpose();
      moduli_.col(t) << e(0, 0), e(0, 1), e(1, 1);
    }
  }

  Eigen::Index size() const { return points_ + static_cast<Eigen::Index>(problem_.mesh.edges.size()); }

  /// The second derivative times v.
  void apply(const Eigen::VectorXd& v, Eigen::VectorXd& product) const {
    product.setZero();
    for_triangles([&](int t, const std::array<int, 6>& nodes) {
      Local own;
      for (int k = 0; k < 6; ++k) own[k] = v[nodes[k]];
      const Local change = moduli_(0, t) * (reference_.xx * own) + moduli_(1, t) * (reference_.xy * own) +
                           moduli_(2, t) * (reference_.yy * own);
      for (int k = 0; k < 6; ++k) product[nodes[k]] += change[k];
    });
  }

  Eigen::VectorXd diagonal() const {
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size());
    for_triangles([&](int t, const std::array<int, 6>& nodes) {
      for (int k = 0; k < 6; ++k)
        diagonal[nodes[k]] += moduli_(0, t) * reference_.xx(k, k) + moduli_(1, t) * reference_.xy(k, k) +
                              moduli_(2, t) * reference_.yy(k, k);
    });
    return diagonal;
  }

  Eigen::VectorXd load() const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(size());
    const Mesh& mesh = problem_.mesh;
    for_triangles([&](int t, const std::array<int, 6>& nodes) {
      const double twice_area = AffineMap(mesh.corners(t)).determinant;
      const Local own = twice_area * reference_.hats * load_at_corners(t, twice_area);
      for (int k = 0; k < 6; ++k) load[nodes[k]] += own[k];
    });
    const TractionField traction(problem_.problem, mesh);
    for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
      if (!traction.acts_on(edge)) continue;
      for (int q = 0; q < EdgeRule::size; ++q) {
        const double s = edge_rule().points[q],
                     force = edge_rule().weights[q] * mesh.length(edge) * traction(edge, 0, s);
        load[mesh.edges[edge][0]] += force * (1 - s) * (1 - 2 * s);
        load[mesh.edges[edge][1]] += force * s * (2 * s - 1);
        load[points_ + edge] += force * 4 * s * (1 - s);
      }
    }
    return load;
  }

 private:
  /// Its mean will do for the nonconforming scheme.
  Eigen::Vector3d load_at_corners(int t, double twice_area) const {
    if (problem_.spaces().order == 1) return LoadValues<1>(problem_).projection(t).transpose();
    return Eigen::Vector3d::Constant(2 / twice_area * problem_.load(0, t));
  }

  template <typename Visit>
  void for_triangles(const Visit& visit) const {
    const Mesh& mesh = problem_.mesh;
    for (int t = 0; t < problem_.triangles(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const auto& [d, e, f] = mesh.triangle_edges[t];
      visit(t, {a, b, c, points_ + d, points_ + e, points_ + f});
    }
  }

  const Discretization& problem_;
  const Reference reference_;
  int points_;
  Eigen::Matrix3Xd moduli_;  ///< of each triangle, for the derivatives on the reference triangle: xx, xy, yy
};

}  // namespace

void relax(const Discretization& problem, QuadraticValues& values, Progress& progress) {
  const Energy energy(problem);
  const Eigen::Index points = values.points.size();
  Eigen::VectorXd v(energy.size());
  v << values.points, values.middles;
  // Nothing moves where the scale is 0.
  Eigen::VectorXd scale = energy.diagonal();
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const bool held = i < points ? values.held_points[i] : values.held_middles[i - points];
    scale[i] = held || scale[i] == 0 ? 0 : 1 / scale[i];
  }

  Eigen::VectorXd product(v.size()), residual = energy.load();
  energy.apply(v, product);
  residual -= product;
  Eigen::VectorXd direction = scale.cwiseProduct(residual);
  double size = residual.dot(direction);
  for (int step = 0; step < kSteps && size > 0; ++step) {
    progress.check();
    energy.apply(direction, product);
    const double length = size / direction.dot(product);
    v += length * direction;
    residual -= length * product;
    const double before = std::exchange(size, residual.dot(scale.cwiseProduct(residual)));
    direction = scale.cwiseProduct(residual) + size / before * direction;
  }
  values.points = v.head(points);
  values.middles = v.tail(v.size() - points);
}

}  // namespace signorini
