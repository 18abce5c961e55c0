#pragma once

#include <array>
#include <variant>

#include "problem/field.hpp"

namespace signorini {

/// The membrane's stiffness κ in σ = κ ∇u: a symmetric positive definite tensor, or a positive number.
struct MembraneStiffness {
  Field xx{1}, xy{0}, yy{1};

  static MembraneStiffness isotropic(const Field& kappa) { return {kappa, Field(0), kappa}; }
};

enum class Plane { strain, stress };

/// Young's modulus E > 0 and Poisson's ratio −1 < ν < 1/2.
struct YoungPoisson {
  Field young, poisson;
  Plane plane = Plane::strain;
};

/// Hooke's tensor as the symmetric positive definite 3×3 matrix in the order xx, yy, xy with engineering
/// shear strain 2 ε_xy; its upper triangle row by row.
struct HookeTensor {
  std::array<Field, 6> entries;
};

using Material = std::variant<MembraneStiffness, YoungPoisson, HookeTensor>;

/// The components of the displacement: 1 for a membrane, 2 for an elastic body.
int components(const Material& material);

bool is_constant(const Material& material);

/// C as a matrix over the entries of a stress row by row: (σ_x, σ_y) for a membrane, (σ_xx, σ_xy, σ_yx, σ_yy)
/// for an elastic body, where it acts on tensors that need not be symmetric: C on the symmetric part, and on
/// the skew part the mean compliance of trace-free stresses, which is 1/(2μ) for an isotropic body.
using Compliance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 4, 4>;

/// C at x. Throws InvalidProblem where the stiffness is not positive definite.
Compliance compliance_at(const Material& material, const Point& x);

/// C σ = shear (σ − ½ tr σ I) + volume ½ tr σ I, which is as true of a σ that is not symmetric. As ν → 1/2
/// the entries of C lose the digits of the volume's strain.
struct IsotropicCompliance {
  double shear, volume;
};

/// Of the material at x. Throws as compliance_at().
IsotropicCompliance isotropic_compliance_at(const YoungPoisson& material, const Point& x);

}  // namespace signorini
