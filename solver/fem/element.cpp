#include "fem/element.hpp"

#include "fem/couple.hpp"
#include "fem/lagrange.hpp"

namespace signorini {

Element::Element(const Problem& problem)
    : problem_(problem),
      spaces_(spaces_of(problem.scheme, components(problem.material))),
      constant_material_(is_constant(problem.material)) {
  if (constant_material_) compliance_ = compliance_at(problem.material, Point::Zero());
  const int n = spaces_.row.size();
  for (auto& row : moments_)
    for (RowMatrix& moment : row) moment = RowMatrix::Zero(n, n);
  for (LocalVectors& moment : hat_moments_) moment = LocalVectors::Zero(2, n);
  of_loads_ = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, spaces_.displacements() / spaces_.components);
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Point& x = triangle_rule().points[q];
    const double weight = triangle_rule().weights[q];
    tau_[q] = spaces_.row.reference_values(x);
    of_loads_ += weight * quadratic_basis(x) * triangle_basis(spaces_.order, x).transpose();
    arms_of_loads_ += weight * quadratic_basis(x) * (x - Point(1. / 3, 1. / 3)).transpose();
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l < 2; ++l) moments_[k][l] += weight * tau_[q].row(k).transpose() * tau_[q].row(l);
    const LocalVector hats = triangle_basis(1, x);
    for (int z = 0; z < 3; ++z) hat_moments_[z] += weight * hats[z] * tau_[q];
  }
}

ElementMatrices Element::matrices(const Mesh& mesh, int triangle) const {
  const AffineMap map(mesh.corners(triangle));
  return {constant_material_ ? constant_form(map, compliance_) : varying_compliance(map),
          map.determinant * spaces_.displacement_mass, skew(map)};
}

// Under the Piola map the rows i, j with functions a, b give (C τ_a, τ_b) = ∫ τ̂_aᵀ Jᵀ C_ij J τ̂_b / det J over
// the reference triangle, with C_ij the 2×2 block of C for these rows.

LocalMatrix Element::constant_form(const AffineMap& map, const Compliance& compliance) const {
  const int d = spaces_.components, n = spaces_.row.size();
  LocalMatrix all(spaces_.stresses(), spaces_.stresses());
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < d; ++j) {
      const Eigen::Matrix2d c =
          map.jacobian.transpose() * compliance.block<2, 2>(2 * i, 2 * j) * map.jacobian / map.determinant;
      for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a)
          all(a * d + i, b * d + j) = c(0, 0) * moments_[0][0](a, b) + c(0, 1) * moments_[0][1](a, b) +
                                      c(1, 0) * moments_[1][0](a, b) + c(1, 1) * moments_[1][1](a, b);
    }
  return all;
}

LocalMatrix Element::varying_compliance(const AffineMap& map) const {
  const int d = spaces_.components, n = spaces_.row.size();
  LocalMatrix all = LocalMatrix::Zero(spaces_.stresses(), spaces_.stresses());
  for (int q = 0; q < TriangleRule::size; ++q) {
    const Compliance compliance = compliance_at(problem_.material, map(triangle_rule().points[q]));
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j) {
        const Eigen::Matrix2d c =
            map.jacobian.transpose() * compliance.block<2, 2>(2 * i, 2 * j) * map.jacobian / map.determinant;
        const RowMatrix block = triangle_rule().weights[q] * tau_[q].transpose() * c * tau_[q];
        for (int b = 0; b < n; ++b)
          for (int a = 0; a < n; ++a) all(a * d + i, b * d + j) += block(a, b);
      }
  }
  return all;
}

LocalVector StrainMoments::operator()(const LocalVector& stress) const {
  if (values.rows() == 0) return compliance.lazyProduct(stress);
  return values.transpose().lazyProduct(moduli.cwiseProduct(values.lazyProduct(stress)));
}

StrainMoments Element::strain_moments(const Mesh& mesh, int triangle, const LocalMatrix& compliance) const {
  StrainMoments moments;
  const auto* material = std::get_if<YoungPoisson>(&problem_.material);
  if (!material) {
    moments.compliance = compliance;
    return moments;
  }
  const AffineMap map(mesh.corners(triangle));
  moments.values.setZero(4 * TriangleRule::size, spaces_.stresses());
  moments.moduli.resize(4 * TriangleRule::size);
  for (int q = 0; q < TriangleRule::size; ++q) {
    const auto [shear, volume] = isotropic_compliance_at(*material, map(triangle_rule().points[q]));
    const double weight = triangle_rule().weights[q] * map.determinant;
    moments.moduli.segment<4>(4 * q) << 2 * weight * volume, 2 * weight * shear, weight * shear,
        weight * shear;
    for (int a = 0; a < spaces_.row.size(); ++a) {
      const Vector tau = map.jacobian * tau_[q].col(a) / map.determinant;
      moments.values.block<4, 2>(4 * q, 2 * a) << tau.x() / 2, tau.y() / 2, tau.x() / 2, -tau.y() / 2,
          tau.y(), 0, 0, tau.x();
    }
  }
  return moments;
}

LocalMatrix Element::skew(const AffineMap& map) const {
  LocalMatrix skew(spaces_.rotations(), spaces_.stresses());
  for (int z = 0; z < spaces_.rotations(); ++z) {
    for (int a = 0; a < spaces_.row.size(); ++a) {
      const Vector moment = map.jacobian * hat_moments_[z].col(a);  // ∫ φ_z τ_a over the triangle
      skew(z, 2 * a) = moment.y();                                  // τ_xy of the first row
      skew(z, 2 * a + 1) = -moment.x();                             // τ_yx of the second row
    }
  }
  return skew;
}

LocalMatrix Element::stress_mass(const Mesh& mesh, int triangle) const {
  const int n = 2 * spaces_.components;
  return constant_form(AffineMap(mesh.corners(triangle)), Compliance::Identity(n, n));
}

TriangleLoad Element::load(const Mesh& mesh, int triangle,
                           const Eigen::Ref<const Eigen::MatrixXd>& quadratic) const {
  const AffineMap map(mesh.corners(triangle));
  const int d = spaces_.components;
  TriangleLoad load{LocalVector(spaces_.displacements())};
  for (int c = 0; c < d; ++c) {
    for (int i = 0; i < of_loads_.cols(); ++i)
      load.force[i * d + c] = map.determinant * quadratic.row(c).dot(of_loads_.col(i));
    if (d == 2)
      load.couple +=
          map.determinant * turned_left(map.jacobian * (quadratic.row(c) * arms_of_loads_).transpose())[c];
  }
  return load;
}

}  // namespace signorini
