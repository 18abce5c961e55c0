#include "certify/balance_potential.hpp"

#include "certify/quadratic_balance.hpp"

namespace signorini {
namespace {

/// The work of −C β on curl φ, which is that of a turned strain on ∇φ.
Eigen::VectorXd work_against(const Discretization& problem, const QuadraticBalance& balance_on) {
  LoadValues<1> load(problem);
  LawField<1> law(problem.problem.material);
  int last = -1;
  std::optional<QuadraticBalance::Data> balance;
  return work_of_stress(problem, [&](int t, const Point& reference) -> Vector {
    if (std::exchange(last, t) != t) balance = balance_on(t, load);
    if (!balance) return Vector::Zero();
    const AffineMap map(problem.mesh.corners(t));
    const Vector strain = law(map(reference)).compliance * QuadraticBalance::value(map, reference, *balance);
    return {strain.y(), -strain.x()};
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
