#include "certify/triangle_sums.hpp"

namespace signorini {
namespace {

/// What a triangle with lifts is cut into along each side, for their integrals.
constexpr int kCuts = 4;

std::vector<Point> points_of(const std::vector<WeightedPoint>& rule) {
  std::vector<Point> points;
  for (const auto& [point, weight] : rule) points.push_back(point);
  return points;
}

}  // namespace

TriangleSums& TriangleSums::operator+=(const TriangleSums& other) {
  gap += other.gap;
  direct_gap += other.direct_gap;
  correction += other.correction;
  skew += other.skew;
  stress += other.stress;
  energy += other.energy;
  span += other.span;
  along += other.along;
  known += other.known;
  moved += other.moved;
  return *this;
}

MembraneSums::Rule::Rule(const Spaces& spaces, int cuts)
    : points(composite_rule(cuts)), stress(spaces, points_of(points)) {
  for (const auto& [point, weight] : points) {
    balance.push_back(QuadraticBalance::reference_values(point));
    basis.push_back(quadratic_basis(point));
    gradients.push_back(quadratic_gradients(point));
  }
}

MembraneSums::MembraneSums(const Discretization& problem, const Eigen::MatrixXd& stress,
                           const AdmissiblePair& pair)
    : problem_(problem),
      stress_(stress),
      pair_(pair),
      balance_(problem),
      plain_(problem.spaces(), 1),
      composite_(problem.spaces(), kCuts) {}

MembraneSums::MembraneSums(const PatchPairs& pairs)
    : MembraneSums(pairs.problem(), pairs.stress(), pairs.first()) {
  second_ = &pairs.second();
  change_ = &pairs.change();
}

TriangleSums MembraneSums::operator()(int t, LawField<1>& law, const LoadValues<1>& load) const {
  const AffineMap map(problem_.mesh.corners(t));
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  const Quadratic<1> v = pair_.v.on<1>(t), potential = pair_.potential_on(problem_.mesh, t);
  Quadratic<1> w = Quadratic<1>::Zero(), potential_of_tau = Quadratic<1>::Zero();
  if (second_) {
    w = v - second_->v.on<1>(t);
    potential_of_tau = potential - second_->potential_on(problem_.mesh, t);
  }
  const Quadratic<1> balanced = load.projection(t).balanced;
  const std::optional<QuadraticBalance::Data> balance = balance_(t, load);
  const bool curled = !potential.isZero(0), lifted = pair_.v.is_lifted(t);
  const Rule& rule = lifted ? composite_ : plain_;
  TriangleSums sums;
  for (int q = 0; q < static_cast<int>(rule.points.size()); ++q) {
    const auto& [reference, share] = rule.points[q];
    const Point x = map(reference);
    const auto& [compliance, stiffness] = law(x);
    const double weight = share * map.determinant;
    const Tensor<1> sigma = rule.stress(q, map, stress_.col(t));
    Eigen::Matrix<double, 1, 1> value = v * rule.basis[q];
    Tensor<1> slope = gradient<1>(inverse, v * rule.gradients[q].transpose());
    // The rest of f is orthogonal to v, where that is quadratic.
    double f = balanced * rule.basis[q];
    if (lifted) {
      pair_.v.add_lifts<1>(t, reference, inverse, value, slope);
      f = problem_.problem.body(0, x);
    }
    Tensor<1> correction = Tensor<1>::Zero();
    if (curled) correction = curl(inverse, potential * rule.gradients[q].transpose());
    if (change_) correction += rule.stress(q, map, change_->col(t));
    if (balance) correction += map.jacobian * (rule.balance[q] * *balance) / map.determinant;
    const Tensor<1> direct_gap = compliance * sigma - slope, gap = direct_gap + compliance * correction;
    sums.gap += weight * gap.dot(stiffness * gap);
    sums.direct_gap += weight * direct_gap.dot(stiffness * direct_gap);
    sums.correction += weight * correction.dot(compliance * correction);
    sums.stress += weight * sigma.dot(compliance * sigma);
    sums.energy += weight * (0.5 * slope.dot(stiffness * slope) - f * value[0]);
    if (!second_) continue;
    const Tensor<1> strain = gradient<1>(inverse, w * rule.gradients[q].transpose()),
                    moved = stiffness * strain,
                    tau = curl(inverse, potential_of_tau * rule.gradients[q].transpose());
    sums.span += weight * (moved + tau).dot(compliance * (moved + tau));
    sums.along += weight * (moved + tau).dot(compliance * correction);
    sums.known += weight * gap.dot(moved - tau);
    sums.moved += weight * strain.dot(moved);
  }
  return sums;
}

}  // namespace signorini
