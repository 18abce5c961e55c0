#include "certify/displacement/displacement_relaxation.hpp"

#include <algorithm>
#include <array>

#include "certify/data/balanced_load.hpp"
#include "certify/displacement/star_relaxation.hpp"
#include "certify/elasticity/johnson_mercier.hpp"
#include "certify/local_fields.hpp"
#include "certify/tensor.hpp"
#include "fem/per_shape.hpp"
#include "fem/small_matrices.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

constexpr int kNodes = JohnsonMercier::kNodes, kOuter = 6, kFollowing = kNodes - kOuter;

using Matrix = TriangleForms::Matrix;
using FormVector = TriangleForms::Vector;

/// The integrals over the reference triangle of products of the ten functions' derivatives and a weight, and
/// of their products with P2.
struct ReferenceProducts {
  using Square = Eigen::Matrix<double, kNodes, kNodes>;

  template <typename Weight>
  explicit ReferenceProducts(const Weight& weight_at) {
    for (const JohnsonMercier::Place& place : JohnsonMercier::places(weighted(triangle_rule()))) {
      const double weight = place.weight * weight_at(place.point);
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
          slopes[a][b] +=
              weight * place.displacement_gradients.row(a).transpose() * place.displacement_gradients.row(b);
    }
  }

  /// [a][b]: of ∂_a φ_i ∂_b φ_j.
  std::array<std::array<Square, 2>, 2> slopes{
      {{Square::Zero(), Square::Zero()}, {Square::Zero(), Square::Zero()}}};
};

/// Of 1, or of the three hats.
const std::vector<ReferenceProducts>& reference_products(bool is_constant) {
  static const std::vector<ReferenceProducts> of_one{ReferenceProducts([](const Point&) { return 1.; })};
  static const std::vector<ReferenceProducts> of_hats = [] {
    std::vector<ReferenceProducts> all;
    for (int z = 0; z < 3; ++z) all.emplace_back([z](const Point& x) { return triangle_basis(1, x)[z]; });
    return all;
  }();
  return is_constant ? of_one : of_hats;
}

/// (φ_i, P2) on the reference triangle.
const Eigen::Matrix<double, kNodes, 6>& products_with_loads() {
  static const Eigen::Matrix<double, kNodes, 6> all = [] {
    Eigen::Matrix<double, kNodes, 6> sum = decltype(sum)::Zero();
    for (const JohnsonMercier::Place& place : JohnsonMercier::places(weighted(triangle_rule())))
      sum += place.weight * place.displacement_basis * quadratic_basis(place.point).transpose();
    return sum;
  }();
  return all;
}

/// E as the map of slopes (xx, xy, yx, yy): their skew part, a rotation, makes no stress.
Eigen::Matrix4d moduli_of(const TensorMap<2>& stiffness) {
  Eigen::Matrix4d symmetric = Eigen::Matrix4d::Identity();
  symmetric.block<2, 2>(1, 1).setConstant(0.5);
  return symmetric * stiffness * symmetric;
}

/// What a triangle knows of the energy when the values inside it are the best.
struct Condensed {
  Matrix stiffness;
  /// The values inside by those outside, with the opposite sign.
  Eigen::Matrix<double, 2 * kFollowing, 2 * kOuter> follows;
};

/// A modulus counts with its linear part on each triangle, as in relaxation.hpp.
Condensed condensed(const AffineMap& map, bool is_constant, LawField<2>& law) {
  const std::vector<ReferenceProducts>& products = reference_products(is_constant);
  std::vector<Eigen::Matrix4d> moduli;
  if (is_constant) {
    moduli.push_back(moduli_of(law(map({0, 0})).stiffness));
  } else {
    std::array<TensorMap<2>, TriangleRule::size> stiffness;
    for (int q = 0; q < TriangleRule::size; ++q) stiffness[q] = law(map(triangle_rule().points[q])).stiffness;
    for (const TensorMap<2>& corner : linear_modulus(stiffness)) moduli.push_back(moduli_of(corner));
  }
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  Eigen::Matrix<double, 2 * kNodes, 2 * kNodes> all = decltype(all)::Zero();
  for (std::size_t k = 0; k < products.size(); ++k)
    for (int p = 0; p < 2; ++p)
      for (int q = 0; q < 2; ++q) {
        const Eigen::Matrix2d of_slopes =
            map.determinant * inverse * moduli[k].block<2, 2>(2 * p, 2 * q) * inverse.transpose();
        ReferenceProducts::Square sum = ReferenceProducts::Square::Zero();
        for (int a = 0; a < 2; ++a)
          for (int b = 0; b < 2; ++b) sum += of_slopes(a, b) * products[k].slopes[a][b];
        for (int i = 0; i < kNodes; ++i)
          for (int j = 0; j < kNodes; ++j) all(2 * i + p, 2 * j + q) += sum(i, j);
      }
  Condensed own;
  own.follows = solve_definite(all.bottomRightCorner<2 * kFollowing, 2 * kFollowing>(),
                               all.bottomLeftCorner<2 * kFollowing, 2 * kOuter>());
  own.stiffness = all.topLeftCorner<2 * kOuter, 2 * kOuter>() -
                  all.topRightCorner<2 * kOuter, 2 * kFollowing>() * own.follows;
  return own;
}

/// (Πf, φ) for the functions of the triangle, which go on into it as it costs least.
FormVector work_of_load(const Discretization& discrete, int t, const Condensed& own) {
  const double determinant = AffineMap(discrete.mesh.corners(t)).determinant;
  const Eigen::Matrix<double, 2, kNodes> work =
      determinant * balanced_load<2>(discrete, t) * products_with_loads().transpose();
  return work.leftCols<kOuter>().reshaped() -
         own.follows.transpose() * work.rightCols<kFollowing>().reshaped();
}

/// <Πt, φ> for the functions of the triangle.
FormVector work_of_traction(const Discretization& discrete, int t) {
  const Mesh& mesh = discrete.mesh;
  FormVector work = FormVector::Zero();
  for (int e = 0; e < 3; ++e) {
    const int edge = mesh.triangle_edges[t][e];
    if (!discrete.traction.acts_on(edge)) continue;
    const bool forward = mesh.triangles[t][(e + 1) % 3] == mesh.edges[edge][0];
    const std::array<int, 3> nodes{(e + (forward ? 1 : 2)) % 3, (e + (forward ? 2 : 1)) % 3, 3 + e};
    for (int c = 0; c < 2; ++c) {
      const LocalVector own = edge_moments(2, [&](double s) { return discrete.traction(edge, c, s); });
      for (int k = 0; k < 3; ++k) work[2 * nodes[k] + c] += mesh.length(edge) * own[k];
    }
  }
  return work;
}

class Relaxation {
 public:
  Relaxation(const Discretization& discrete, const std::vector<NodeFreedom>& freedom, Eigen::MatrixXd& points,
             Eigen::MatrixXd& middles)
      : discrete_(discrete), mesh_(discrete.mesh), freedom_(freedom), points_(points), middles_(middles) {}

  void run(int sweeps, Progress& progress) {
    take_forms(progress);
    const Eigen::VectorXd x = relax_stars(mesh_, forms_, sweeps, progress);
    for (std::size_t node = 0; node < freedom_.size(); ++node)
      value(static_cast<int>(node)) +=
          axes(static_cast<int>(node)) * x.segment<2>(2 * static_cast<Eigen::Index>(node));
  }

 private:
  Eigen::MatrixXd::ColXpr value(int node) {
    const int points = static_cast<int>(mesh_.points.size());
    return node < points ? points_.col(node) : middles_.col(node - points);
  }

  /// The directions of a node's two functions: what is not free is the second.
  Eigen::Matrix2d axes(int node) const {
    const Vector& n = freedom_[node].normal;
    if (n.isZero(0)) return Eigen::Matrix2d::Identity();
    return (Eigen::Matrix2d() << n.y(), n.x(), -n.x(), n.y()).finished();
  }

  std::array<int, 6> nodes_of(int t) const {
    const int points = static_cast<int>(mesh_.points.size());
    const auto& [a, b, c] = mesh_.triangles[t];
    const auto& [d, e, f] = mesh_.triangle_edges[t];
    return {a, b, c, points + d, points + e, points + f};
  }

  struct Shape {
    Condensed own;
    int number = -1;
    std::vector<int> turned = {};  ///< numbers with nodes that may move along lines only
  };

  void take_forms(Progress& progress) {
    for (const NodeFreedom& own : freedom_) {
      forms_.held.push_back(own.held);
      forms_.held.push_back(own.held || !own.normal.isZero(0));
    }
    forms_.matrix_of.reserve(discrete_.triangles());
    forms_.slopes.reserve(discrete_.triangles());
    in_parts(
        discrete_.triangles(), progress, [this](Part part, Progress& own) { return forms_on(part, own); },
        [this](TriangleForms own) { forms_.append(std::move(own)); });
  }

  TriangleForms forms_on(Part part, Progress& progress) {
    TriangleForms forms;
    LawField<2> law(discrete_.problem.material);
    const bool is_constant = discrete_.element.has_constant_material();
    PerShape<Shape> shapes(discrete_);
    for (int t = part.begin; t < part.end; ++t) {
      progress.check_in(t);
      Shape& shape =
          shapes(t, [&] { return Shape{condensed(AffineMap(mesh_.corners(t)), is_constant, law)}; });
      add(t, shape, forms);
    }
    return forms;
  }

  void add(int t, Shape& shape, TriangleForms& forms) {
    const Condensed& own = shape.own;
    const std::array<int, 6> nodes = nodes_of(t);
    FormVector v;
    for (int k = 0; k < 6; ++k) v.segment<2>(2 * k) = value(nodes[k]);
    FormVector slope = own.stiffness * v - work_of_load(discrete_, t, own) - work_of_traction(discrete_, t);
    if (std::ranges::all_of(nodes, [&](int node) { return freedom_[node].normal.isZero(0); })) {
      if (shape.number < 0) shape.number = forms.keep(own.stiffness);
      forms.matrix_of.push_back(shape.number);
    } else {
      Matrix turn = Matrix::Zero();
      for (int k = 0; k < 6; ++k) turn.block<2, 2>(2 * k, 2 * k) = axes(nodes[k]);
      slope = turn.transpose() * slope;
      forms.matrix_of.push_back(forms.keep(turn.transpose() * own.stiffness * turn, shape.turned));
    }
    forms.slopes.push_back(slope);
  }

  const Discretization& discrete_;
  const Mesh& mesh_;
  const std::vector<NodeFreedom>& freedom_;
  Eigen::MatrixXd &points_, &middles_;
  TriangleForms forms_;  ///< two displacements a node
};

}  // namespace

void NodeFreedom::hold_along(const Vector& n, double rounding_of_n) {
  if (normal.isZero(0)) {
    normal = n;
    rounding = rounding_of_n;
  } else if (!is_same_direction(normal, n, rounding + rounding_of_n)) {
    held = true;
  }
}

void relax_displacement(const Discretization& discrete, const std::vector<NodeFreedom>& freedom, int sweeps,
                        Eigen::MatrixXd& points, Eigen::MatrixXd& middles, Progress& progress) {
  Relaxation(discrete, freedom, points, middles).run(sweeps, progress);
}

}  // namespace signorini
