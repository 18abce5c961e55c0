#include "certify/membrane/membrane_rule.hpp"

#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace signorini {
namespace {

std::vector<Point> points_of(const std::vector<WeightedPoint>& rule) {
  std::vector<Point> points;
  for (const auto& [point, weight] : rule) points.push_back(point);
  return points;
}

/// By the order of the spaces.
template <int Degree>
const MembraneRule& rule_made_once(int order) {
  static const std::array<MembraneRule, 2> rules{
      MembraneRule(spaces_of(Scheme::nonconforming, 1), rule_of_degree(Degree), true),
      MembraneRule(spaces_of(Scheme::conforming, 1), rule_of_degree(Degree), true)};
  return rules[order];
}

}  // namespace

MembraneRule::MembraneRule(const Spaces& spaces, std::vector<WeightedPoint> given, bool balanced)
    : points(std::move(given)), stress(spaces, points_of(points)) {
  for (const auto& [point, weight] : points) {
    if (balanced) balance.push_back(QuadraticBalance::reference_values(point));
    basis.push_back(quadratic_basis(point));
    gradients.push_back(quadratic_gradients(point));
  }
}

const MembraneRule& membrane_rule(const Spaces& spaces, int degree) {
  const int order = spaces.order;
  if (degree <= 2) return rule_made_once<2>(order);
  if (degree <= 4) return rule_made_once<4>(order);
  if (degree <= 5) return rule_made_once<5>(order);
  if (degree <= 6) return rule_made_once<6>(order);
  if (degree <= 8) return rule_made_once<8>(order);
  if (degree <= 10) return rule_made_once<10>(order);
  return degree <= 18 ? rule_made_once<18>(order) : rule_made_once<30>(order);
}

MembraneNorms::MembraneNorms(const Spaces& spaces, const AffineMap& map, const Law<1>& law) {
  const MembraneRule& rule = membrane_rule(spaces, kDegree);
  // C = L Lᵀ and E = L⁻ᵀ L⁻¹: σ·Cσ = |Lᵀ σ|², ε·Eε = |L⁻¹ ε|² and L⁻¹ C σ = Lᵀ σ.
  const Eigen::LLT<Eigen::Matrix2d> factor(law.compliance);
  const Eigen::Matrix2d of_stress = factor.matrixU(), inverse = map.jacobian.inverse();
  const Eigen::Matrix2d of_strain = factor.matrixL().solve(inverse.transpose()),
                        of_reference = of_stress * map.jacobian / map.determinant;
  const int functions = rule.stress.functions();
  stress.resize(Eigen::NoChange, functions);
  for (int q = 0; q < kPoints; ++q) {
    const double root = std::sqrt(rule.points[q].weight * map.determinant);
    const Eigen::Matrix<double, 2, 6> slopes = inverse.transpose() * rule.gradients[q];
    Eigen::Matrix<double, 2, 6> curls;
    curls << slopes.row(1), -slopes.row(0);
    for (int a = 0; a < functions; ++a)
      stress.col(a).segment<2>(2 * q) =
          root * of_stress * rule.stress(q, map, LocalVector::Unit(functions, a));
    stream_function.middleRows<2>(2 * q) = root * of_stress * curls;
    balance.middleRows<2>(2 * q) = root * of_reference * rule.balance[q];
    strain.middleRows<2>(2 * q) = root * of_strain * rule.gradients[q];
  }
}

}  // namespace signorini
