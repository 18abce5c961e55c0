#include "certify/membrane/balance_stream_function.hpp"

#include "certify/membrane/quadratic_balance.hpp"

namespace signorini {
namespace {

/// The work of −C β on curl φ, which is that of a turned strain on ∇φ.
Eigen::VectorXd work_against(const Discretization& discrete, const QuadraticBalance& balance_on) {
  LawField<1> law(discrete.problem.material);
  return work_of_stress(discrete, [&](int t) -> StressAtPoints {
    const auto balance = balance_on(t);
    if (!balance) return StressAtPoints::Zero();
    const AffineMap map(discrete.mesh.corners(t));
    StressAtPoints turned = QuadraticBalance::at_points(map, *balance);
    for (int q = 0; q < TriangleRule::size; ++q) {
      const Vector strain = law(map(triangle_rule().points[q])).compliance * turned.col(q);
      turned.col(q) << strain.y(), -strain.x();
    }
    return turned;
  });
}

}  // namespace

std::optional<QuadraticValues> stream_function_of_balance(const Discretization& discrete,
                                                          Progress& progress) {
  constexpr int steps = 6;
  if (discrete.spaces().components == 2) return std::nullopt;
  const QuadraticBalance balance(discrete);
  if (!balance.is_needed()) return std::nullopt;
  QuadraticValues stream_function(discrete.mesh);
  for (const BoundaryPart& part : discrete.mesh.boundary)
    if (!condition_on<Fixed>(discrete.problem, part.name))
      for (const int edge : part.edges) stream_function.hold(discrete.mesh, edge);
  relax(discrete, turned_compliance_of, stream_function, work_against(discrete, balance), steps, progress);
  return stream_function;
}

}  // namespace signorini
