#include "certify/balance_potential.hpp"

#include "certify/quadratic_balance.hpp"

namespace signorini {
namespace {

/// The work of −C β on curl φ, by which it is that of a turned strain on ∇φ; empty if there is no β.
Eigen::VectorXd work_against_balance(const Discretization& problem) {
  const QuadraticBalance balance_on(problem);
  LoadValues<1> load(problem);
  LawField<1> law(problem.problem.material);
  int last = -1;
  bool lacks = false;
  std::optional<QuadraticBalance::Data> balance;
  const Eigen::VectorXd work = work_of_stress(problem, [&](int t, const Point& reference) -> Vector {
    if (std::exchange(last, t) != t) balance = balance_on(t, load);
    if (!balance) return Vector::Zero();
    lacks = true;
    const AffineMap map(problem.mesh.corners(t));
    const Vector strain = law(map(reference)).compliance * QuadraticBalance::value(map, reference, *balance);
    return {strain.y(), -strain.x()};
  });
  return lacks ? work : Eigen::VectorXd();
}

}  // namespace

std::optional<QuadraticValues> potential_of_balance(const Discretization& problem, Progress& progress) {
  constexpr int steps = 6;
  const Eigen::VectorXd work = work_against_balance(problem);
  if (work.size() == 0) return std::nullopt;
  QuadraticValues potential(problem.mesh);
  for (const BoundaryPart& part : problem.mesh.boundary)
    if (!condition_on<Fixed>(problem.problem, part.name))
      for (const int edge : part.edges) potential.hold(problem.mesh, edge);
  relax(problem, turned_compliance_of, potential, work, steps, progress);
  return potential;
}

}  // namespace signorini
