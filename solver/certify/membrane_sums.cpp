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

double value_or_zero(const std::unordered_map<int, double>& values, int key) {
  const auto found = values.find(key);
  return found == values.end() ? 0 : found->second;
}

}  // namespace

TriangleSums& TriangleSums::operator+=(const TriangleSums& other) {
  gap += other.gap;
  direct_gap += other.direct_gap;
  correction += other.correction;
  skew += other.skew;
  stress += other.stress;
  energy += other.energy;
  return *this;
}

MembraneSums::Rule::Rule(const Spaces& spaces, int cuts)
    : points(composite_rule(cuts)),
      stress(spaces, points_of(points)),
      balance(spaces_of(Scheme::conforming, 1), points_of(points)) {
  for (const auto& [point, weight] : points) {
    basis.push_back(quadratic_basis(point));
    gradients.push_back(quadratic_gradients(point));
  }
}

MembraneSums::MembraneSums(const Discretization& problem, const Solution& solution,
                           const AdmissibleDisplacement& v, const ContactPressure& pressure)
    : problem_(problem),
      solution_(solution),
      v_(v),
      pressure_(pressure),
      balance_(problem),
      plain_(problem.spaces(), 1),
      composite_(problem.spaces(), kCuts) {}

TriangleSums MembraneSums::operator()(int t, LawField<1>& law, LoadValues<1>& load) const {
  const AffineMap map(problem_.mesh.corners(t));
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  const Quadratic<1> v = v_.on<1>(t);
  const Quadratic<1> potential = potential_on(t);
  const std::optional<LinearBalance::Coefficients> balance = balance_(t, load);
  const bool curled = !potential.isZero(0), lifted = v_.is_lifted(t);
  const Rule& rule = lifted ? composite_ : plain_;
  TriangleSums sums;
  for (int q = 0; q < static_cast<int>(rule.points.size()); ++q) {
    const auto& [reference, share] = rule.points[q];
    const Point x = map(reference);
    const auto& [compliance, stiffness] = law(x);
    const double weight = share * map.determinant;
    const double f = lifted ? problem_.problem.body(0, x) : load.at_points(t)[q];
    const Tensor<1> sigma = rule.stress(q, map, solution_.stress.col(t));
    Eigen::Matrix<double, 1, 1> value = v * rule.basis[q];
    Tensor<1> slope = gradient<1>(inverse, v * rule.gradients[q].transpose());
    if (lifted) v_.add_lifts<1>(t, reference, inverse, value, slope);
    Tensor<1> correction = Tensor<1>::Zero();
    if (curled) {
      const Tensor<1> rise = gradient<1>(inverse, potential * rule.gradients[q].transpose());
      correction << rise[1], -rise[0];
    }
    if (balance) correction += rule.balance(q, map, *balance);
    const Tensor<1> direct_gap = compliance * sigma - slope, gap = direct_gap + compliance * correction;
    sums.gap += weight * gap.dot(stiffness * gap);
    sums.direct_gap += weight * direct_gap.dot(stiffness * direct_gap);
    sums.correction += weight * correction.dot(compliance * correction);
    sums.stress += weight * sigma.dot(compliance * sigma);
    sums.energy += weight * (0.5 * slope.dot(stiffness * slope) - f * value[0]);
  }
  return sums;
}

/// The potential of the pressure.
Quadratic<1> MembraneSums::potential_on(int t) const {
  Quadratic<1> values = Quadratic<1>::Zero();
  if (pressure_.potential_at_points.empty()) return values;
  for (int k = 0; k < 3; ++k) {
    values[k] = value_or_zero(pressure_.potential_at_points, problem_.mesh.triangles[t][k]);
    values[3 + k] = value_or_zero(pressure_.potential_at_middles, problem_.mesh.triangle_edges[t][k]);
  }
  return values;
}

}  // namespace signorini
