#include "certify/displacement/relaxation.hpp"

#include <Eigen/LU>

#include "certify/data/balanced_load.hpp"
#include "certify/local_fields.hpp"
#include "certify/tensor.hpp"
#include "fem/lagrange.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

using Local = Eigen::Matrix<double, 6, 1>;
using LocalSquare = Eigen::Matrix<double, 6, 6>;

/// The integrals over the reference triangle of products of the six functions' derivatives and a weight.
struct Products {
  template <typename Weight>
  explicit Products(const Weight& weight_at) {
    for (int q = 0; q < TriangleRule::size; ++q) {
      const double weight = triangle_rule().weights[q] * weight_at(triangle_rule().points[q]);
      const Eigen::Matrix<double, 2, 6>& slope = quadratic_gradients()[q];
      xx += weight * slope.row(0).transpose() * slope.row(0);
      xy += weight * (slope.row(0).transpose() * slope.row(1) + slope.row(1).transpose() * slope.row(0));
      yy += weight * slope.row(1).transpose() * slope.row(1);
    }
  }

  LocalSquare xx = LocalSquare::Zero(), xy = LocalSquare::Zero(), yy = LocalSquare::Zero();
};

std::array<int, 6> nodes_of(const Mesh& mesh, int t) {
  const int points = static_cast<int>(mesh.points.size());
  const auto& [a, b, c] = mesh.triangles[t];
  const auto& [d, e, f] = mesh.triangle_edges[t];
  return {a, b, c, points + d, points + e, points + f};
}

template <typename Visit>
void for_triangles(const Mesh& mesh, const Visit& visit) {
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) visit(t, nodes_of(mesh, t));
}

/// Σ over the triangles of what each adds at its nodes.
template <typename AtNodes>
void add_at_nodes(const Mesh& mesh, const AtNodes& at_nodes, Eigen::VectorXd& sum, Progress& progress) {
  struct Found {
    Part part;
    Eigen::Matrix<double, 6, Eigen::Dynamic> values{6, part.end - part.begin};
  };
  const auto find = [&](Part part, Progress& own) {
    Found found{part};
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      found.values.col(t - part.begin) = at_nodes(t, nodes_of(mesh, t));
    }
    return found;
  };
  in_parts(static_cast<int>(mesh.triangles.size()), progress, find, [&](const Found& found) {
    for (int t = found.part.begin; t < found.part.end; ++t) {
      const std::array<int, 6> nodes = nodes_of(mesh, t);
      for (int k = 0; k < 6; ++k) sum[nodes[k]] += found.values(k, t - found.part.begin);
    }
  });
}

Eigen::Index functions(const Mesh& mesh) {
  return static_cast<Eigen::Index>(mesh.points.size() + mesh.edges.size());
}

using Modulus = Eigen::Matrix2d (*)(const Law<1>&);

/// The second derivative of ½ ‖∇v‖²_M. The modulus is constant on each triangle, or linear: then it is that
/// at the corners times the hats.
class Curvature {
 public:
  Curvature(const Discretization& discrete, Modulus of, Progress& progress) : mesh_(discrete.mesh) {
    if (discrete.element.has_constant_material())
      products_.emplace_back([](const Point&) { return 1.; });
    else
      for (int z = 0; z < 3; ++z)
        products_.emplace_back([z](const Point& x) { return triangle_basis(1, x)[z]; });
    take_moduli(discrete, of, progress);
  }

  void apply(const Eigen::VectorXd& v, Eigen::VectorXd& product, Progress& progress) const {
    product.setZero();
    const auto at_nodes = [&](int t, const std::array<int, 6>& nodes) {
      Local own, change = Local::Zero();
      for (int k = 0; k < 6; ++k) own[k] = v[nodes[k]];
      for (std::size_t i = 0; i < products_.size(); ++i) {
        const Eigen::Vector3d e = modulus(t, i);
        change +=
            e[0] * (products_[i].xx * own) + e[1] * (products_[i].xy * own) + e[2] * (products_[i].yy * own);
      }
      return change;
    };
    add_at_nodes(mesh_, at_nodes, product, progress);
  }

  Eigen::VectorXd diagonal() const {
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(functions(mesh_));
    for_triangles(mesh_, [&](int t, const std::array<int, 6>& nodes) {
      for (std::size_t i = 0; i < products_.size(); ++i) {
        const Eigen::Vector3d e = modulus(t, i);
        for (int k = 0; k < 6; ++k)
          diagonal[nodes[k]] +=
              e[0] * products_[i].xx(k, k) + e[1] * products_[i].xy(k, k) + e[2] * products_[i].yy(k, k);
      }
    });
    return diagonal;
  }

 private:
  /// For the derivatives on the reference triangle: xx, xy, yy.
  Eigen::Vector3d modulus(int t, std::size_t i) const {
    return moduli_.col(t).segment<3>(3 * static_cast<Eigen::Index>(i));
  }

  void take_moduli(const Discretization& discrete, Modulus of, Progress& progress) {
    moduli_.resize(products_.size() == 1 ? 3 : 9, discrete.triangles());
    in_parts(discrete.triangles(), progress,
             [&](Part part, Progress& own) { take_moduli(discrete, of, part, own); });
  }

  void take_moduli(const Discretization& discrete, Modulus of, Part part, Progress& progress) {
    LawField<1> law(discrete.problem.material);
    const bool constant = products_.size() == 1;
    const auto kept = [](const Eigen::Matrix2d& e) { return Eigen::Vector3d(e(0, 0), e(0, 1), e(1, 1)); };
    for (int t = part.begin; t < part.end; ++t) {
      progress.check_in(t);
      const AffineMap map(mesh_.corners(t));
      const Eigen::Matrix2d inverse = map.jacobian.inverse();
      const auto at = [&](const Point& x) -> Eigen::Matrix2d {
        return map.determinant * inverse * of(law(x)) * inverse.transpose();
      };
      if (constant) {
        moduli_.col(t) = kept(at(mesh_.centroid(t)));
        continue;
      }
      std::array<Eigen::Matrix2d, TriangleRule::size> at_points;
      for (int q = 0; q < TriangleRule::size; ++q) at_points[q] = at(map(triangle_rule().points[q]));
      const std::array<Eigen::Matrix2d, 3> corners = linear_modulus(at_points);
      moduli_.col(t) << kept(corners[0]), kept(corners[1]), kept(corners[2]);
    }
  }

  const Mesh& mesh_;
  std::vector<Products> products_;
  Eigen::MatrixXd moduli_;
};

/// (φ, hat) for the six functions and the three hats, on the reference triangle.
Eigen::Matrix<double, 6, 3> products_with_hats() {
  Eigen::Matrix<double, 6, 3> products = Eigen::Matrix<double, 6, 3>::Zero();
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point& x = triangle_rule().points[q];
    products += triangle_rule().weights[q] * quadratic_basis(x) * triangle_basis(1, x).transpose();
  }
  return products;
}

void add_work_of_traction(const Discretization& discrete, Eigen::VectorXd& work) {
  const Mesh& mesh = discrete.mesh;
  const TractionField& traction = discrete.traction;
  const Eigen::Index points = static_cast<Eigen::Index>(mesh.points.size());
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (!traction.acts_on(edge)) continue;
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q],
                   force = edge_rule().weights[q] * mesh.length(edge) * traction(edge, 0, s);
      work[mesh.edges[edge][0]] += force * (1 - s) * (1 - 2 * s);
      work[mesh.edges[edge][1]] += force * s * (2 * s - 1);
      work[points + edge] += force * 4 * s * (1 - s);
    }
  }
}

}  // namespace

Eigen::VectorXd work_of_loads(const Discretization& discrete, Progress& progress) {
  Eigen::VectorXd work = Eigen::VectorXd::Zero(functions(discrete.mesh));
  const Eigen::Matrix<double, 6, 3> hats = products_with_hats();
  const auto at_nodes = [&](int t, const std::array<int, 6>&) -> Local {
    const double twice_area = AffineMap(discrete.mesh.corners(t)).determinant;
    return twice_area * hats * discrete_load<1>(discrete, t).transpose();
  };
  add_at_nodes(discrete.mesh, at_nodes, work, progress);
  add_work_of_traction(discrete, work);
  return work;
}

Eigen::VectorXd work_of_stress(const Discretization& discrete, const StressField& tau) {
  Eigen::VectorXd work = Eigen::VectorXd::Zero(functions(discrete.mesh));
  for_triangles(discrete.mesh, [&](int t, const std::array<int, 6>& nodes) {
    const AffineMap map(discrete.mesh.corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    const StressAtPoints stress = map.determinant * inverse * tau(t);
    Local own = Local::Zero();
    for (int q = 0; q < TriangleRule::size; ++q)
      own += triangle_rule().weights[q] * quadratic_gradients()[q].transpose() * stress.col(q);
    for (int k = 0; k < 6; ++k) work[nodes[k]] += own[k];
  });
  return work;
}

QuadraticValues::QuadraticValues(const Mesh& mesh)
    : points(Eigen::VectorXd::Zero(mesh.points.size())),
      middles(Eigen::VectorXd::Zero(mesh.edges.size())),
      held_points(mesh.points.size(), false),
      held_middles(mesh.edges.size(), false) {}

Quadratic<1> QuadraticValues::on(const Mesh& mesh, int t) const {
  Quadratic<1> own;
  for (int k = 0; k < 3; ++k) {
    own[k] = points[mesh.triangles[t][k]];
    own[3 + k] = middles[mesh.triangle_edges[t][k]];
  }
  return own;
}

void QuadraticValues::hold(const Mesh& mesh, int edge) {
  held_middles[edge] = true;
  for (const int point : mesh.edges[edge]) held_points[point] = true;
}

Eigen::Matrix2d stiffness_of(const Law<1>& law) {
  return law.stiffness;
}

Eigen::Matrix2d turned_compliance_of(const Law<1>& law) {
  return law.stiffness / law.stiffness.determinant();
}

void relax(const Discretization& discrete, Modulus modulus, QuadraticValues& values,
           const Eigen::VectorXd& work, int steps, Progress& progress) {
  const Curvature curvature(discrete, modulus, progress);
  const Eigen::Index points = values.points.size();
  Eigen::VectorXd v(work.size());
  v << values.points, values.middles;
  // Nothing moves where the scale is 0.
  Eigen::VectorXd scale = curvature.diagonal();
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const bool held = i < points ? values.held_points[i] : values.held_middles[i - points];
    scale[i] = held || scale[i] == 0 ? 0 : 1 / scale[i];
  }

  Eigen::VectorXd product(v.size()), residual = work;
  curvature.apply(v, product, progress);
  residual -= product;
  Eigen::VectorXd direction = scale.cwiseProduct(residual);
  double size = residual.dot(direction);
  for (int step = 0; step < steps && size > 0; ++step) {
    progress.check();
    curvature.apply(direction, product, progress);
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
