#include "problem/material.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace signorini {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& detail, const Point& x) {
  throw InvalidProblem({{name, detail + " at " + to_string(x)}});
}

Compliance at(const MembraneStiffness& stiffness, const Point& x) {
  const double xx = stiffness.xx(x), xy = stiffness.xy(x), yy = stiffness.yy(x);
  // xy² < xx yy with a margin over rounding, by quotients, which do not overflow: a matrix that is singular
  // but for rounding is no stiffness.
  const bool positive = xx > 0 && yy > 0 && (xy / xx) * (xy / yy) < 1 - 1e-14;
  if (!positive) refuse("/material/stiffness", "is not positive definite", x);
  Eigen::Matrix2d matrix;
  matrix << xx, xy, xy, yy;
  return matrix.inverse();
}

/// C for stresses as vectors (σ_xx, σ_yy, √2 σ_xy), extended to all 2×2 tensors.
Compliance extend(const Eigen::Matrix3d& mandel) {
  // The mean over trace-free stresses (1, −1, 0)/√2 and (0, 0, 1).
  const double deviatoric = 0.5 * ((mandel(0, 0) - 2 * mandel(0, 1) + mandel(1, 1)) / 2 + mandel(2, 2));
  Eigen::Matrix<double, 3, 4> symmetric;  // (σ_xx, σ_yy, √2 σ_xy) of the symmetric part
  symmetric << 1, 0, 0, 0, 0, 0, 0, 1, 0, std::sqrt(0.5), std::sqrt(0.5), 0;
  const Eigen::RowVector4d skew(0, std::sqrt(0.5), -std::sqrt(0.5), 0);
  return symmetric.transpose() * mandel * symmetric + deviatoric * skew.transpose() * skew;
}

Compliance at(const YoungPoisson& material, const Point& x) {
  const auto [shear, volume] = isotropic_compliance_at(material, x);
  Compliance compliance = shear * Compliance::Identity(4, 4);
  compliance(0, 0) = compliance(3, 3) = (volume + shear) / 2;
  compliance(0, 3) = compliance(3, 0) = (volume - shear) / 2;
  return compliance;
}

Compliance at(const HookeTensor& tensor, const Point& x) {
  Eigen::Matrix3d stiffness;
  int next = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) stiffness(i, j) = stiffness(j, i) = tensor.entries[next++](x);
  // Engineering shear 2 ε_xy against √2 ε_xy.
  const Eigen::Vector3d scale(1, 1, std::sqrt(2.));
  const Eigen::Matrix3d mandel = scale.asDiagonal() * stiffness * scale.asDiagonal();
  // Positive definite with a margin over rounding, whatever the units of the entries.
  const Eigen::LDLT<Eigen::Matrix3d> factor(mandel);
  const Eigen::Vector3d pivots = factor.vectorD();
  const bool positive = pivots.minCoeff() > 1e-14 * mandel.diagonal().cwiseAbs().maxCoeff();
  if (!positive) refuse("/material/tensor", "is not positive definite", x);
  return extend(mandel.inverse());
}

}  // namespace

int components(const Material& material) {
  return std::holds_alternative<MembraneStiffness>(material) ? 1 : 2;
}

bool is_constant(const Material& material) {
  if (const auto* membrane = std::get_if<MembraneStiffness>(&material))
    return membrane->xx.is_constant() && membrane->xy.is_constant() && membrane->yy.is_constant();
  if (const auto* isotropic = std::get_if<YoungPoisson>(&material))
    return isotropic->young.is_constant() && isotropic->poisson.is_constant();
  return std::ranges::all_of(std::get<HookeTensor>(material).entries, &Field::is_constant);
}

Compliance compliance_at(const Material& material, const Point& x) {
  return std::visit([&](const auto& own) { return at(own, x); }, material);
}

/// No difference of the two moduli is taken: near ν = 1/2 it would be all that is left of the volume's.
IsotropicCompliance isotropic_compliance_at(const YoungPoisson& material, const Point& x) {
  const double young = material.young(x), poisson = material.poisson(x);
  if (!(young > 0)) refuse("/material/young", "must be positive, is not", x);
  if (!(poisson > -1 && poisson < 0.5))
    refuse("/material/poisson", "must lie between -1 and 1/2, does not", x);
  const double shear = (1 + poisson) / young;
  return {shear, material.plane == Plane::strain ? shear * (1 - 2 * poisson) : (1 - poisson) / young};
}

}  // namespace signorini
