#pragma once

#include <vector>

#include "certify/local_fields.hpp"
#include "certify/membrane/quadratic_balance.hpp"
#include "certify/tensor.hpp"
#include "fem/cubature.hpp"

namespace signorini {

/// Where the sums of a membrane are evaluated, with what does not depend on the triangle.
struct MembraneRule {
  /// `balanced`: with the values of QuadraticBalance.
  MembraneRule(const Spaces& spaces, std::vector<WeightedPoint> points, bool balanced);

  std::vector<WeightedPoint> points;
  StressValues<1> stress;
  std::vector<QuadraticBalance::Values> balance;
  std::vector<Eigen::Matrix<double, 6, 1>> basis;
  std::vector<Eigen::Matrix<double, 2, 6>> gradients;
};

/// Exact for polynomials of the degree, on a whole triangle; made once.
const MembraneRule& membrane_rule(const Spaces& spaces, int degree);

/// The fields at the points of the rule of degree 6, which squares of what balances a load ask for, for all
/// triangles of one shape and law: times what they depend on, as columns whose squares of norms are the
/// integrals, of stresses in the norm of C and of strains in that of E. A column of one kind is that of the
/// other: ‖C σ − ε(v)‖²_E is the square of their difference.
struct MembraneNorms {
  static constexpr int kDegree = 6, kPoints = 12;
  using Column = Eigen::Matrix<double, 2 * kPoints, 1>;
  template <int Count, int Most = Count>
  using Columns = Eigen::Matrix<double, 2 * kPoints, Count, 0, 2 * kPoints, Most>;

  MembraneNorms(const Spaces& spaces, const AffineMap& map, const Law<1>& law);

  Columns<Eigen::Dynamic, 8> stress;         ///< of σ_h by its coefficients
  Columns<6> stream_function;                ///< curl Ψ by the values of Ψ at the nodes
  Columns<QuadraticBalance::kData> balance;  ///< by the data of QuadraticBalance
  Columns<6> strain;                         ///< ∇v by the values of v at the nodes
};

}  // namespace signorini
