#include "certify/membrane/balance_potential.hpp"

#include "certify/membrane/quadratic_balance.hpp"

namespace signorini {
namespace {

/// The work of −C β on curl φ, which is that of a turned strain on ∇φ.
Eigen::VectorXd work_against(const Discretization& problem, const QuadraticBalance& balance_on) {
  LawField<1> law(problem.problem.material);
  return work_of_stress(problem, [&](int t) -> StressAtPoints {
    const auto balance = balance_on(t);
    if (!balance) return StressAtPoints::Zero();
    const AffineMap map(problem.mesh.corners(t));
    StressAtPoints turned = QuadraticBalance::at_points(map, *balance);
    for (int q = 0; q < TriangleRule::size; ++q) {
      const Vector strain = law(map(triangle_rule().points[q])).compliance * turned.col(q);
      turned.col(q) << strain.y(), -strain.x();
    }
    return turned;
  });
}

}  // namespace

std::optional<QuadraticValues> potential_of_balance(const Discretization& problem, Progress& progress) {
  constexpr int steps = 6;
  const QuadraticBalance balance(problem);
  if (!balance.is_needed()) return std::nullopt;
  QuadraticValues potential(problem.mesh);
  for (const BoundaryPart& part : problem.mesh.boundary)
    if (!condition_on<Fixed>(problem.problem, part.name))
      for (const int edge : part.edges) potential.hold(problem.mesh, edge);
  relax(problem, turned_compliance_of, potential, work_against(problem, balance), steps, progress);
  return potential;
}

}  // namespace signorini
