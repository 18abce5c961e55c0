#include "certify/triangle_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "certify/data/balanced_load.hpp"
#include "certify/rounding.hpp"

namespace signorini {

TriangleSums& TriangleSums::operator+=(const TriangleSums& other) {
  gap += other.gap;
  direct_gap += other.direct_gap;
  correction += other.correction;
  skew += other.skew;
  stress += other.stress;
  energy += other.energy;
  strain += other.strain;
  span += other.span;
  along += other.along;
  known += other.known;
  moved += other.moved;
  slack += other.slack;
  energy_slack += other.energy_slack;
  return *this;
}

void TriangleSums::add_unknown_strain(double zeta) {
  if (zeta == 0) return;
  const auto norm = [this](double square) { return std::sqrt(square + slack); };
  const double fields = norm(gap) + norm(direct_gap) + norm(correction) + 2 * norm(span) + 4 * norm(moved);
  slack += zeta * (2 * fields + zeta);
}

/// Rounding changes the entries of C by a part of the largest, which is that times their contrast of the
/// smallest; what it changes of a Jacobian J counts |J|²/det J times in what is mapped there and back.
/// Gradients are differences of values, however much alike; and σ* may be what little is left of σ_h, whose
/// equilibrium is no better than its own digits.
void TriangleSums::add_rounding(const AffineMap& map, const LawPiece& law, double largest_value) {
  const double stretch = map.jacobian.squaredNorm() / map.determinant;
  double of_fields = stretch * stretch * (std::sqrt(2 * strain) + std::sqrt(gap) + std::sqrt(stress)),
         of_gradients = 0;
  if (law.is_known()) {
    of_fields *= law.softest * law.stiffest;
    of_gradients = std::sqrt(law.stiffest * stretch) * largest_value;
  }
  rounding = kRoundingOfFields * (of_fields + of_gradients);
  energy_slack += rounding * (std::sqrt(2 * strain) + rounding);
}

MembraneSums::MembraneSums(const Discretization& discrete, const Eigen::MatrixXd& stress,
                           const AdmissiblePair& pair, ShapeNorms& norms)
    : MembraneSums(discrete, {{{1, discrete, stress, pair.v}, pair}}, norms) {}

MembraneSums::MembraneSums(const Discretization& discrete, std::vector<Term> terms, ShapeNorms& norms)
    : MembraneSums(discrete, std::move(terms)) {
  norms_ = &norms;
  if (!not_balanced_.empty()) norms.look_over(discrete);
}

MembraneSums::MembraneSums(const PatchPairs& pairs)
    : MembraneSums(pairs.discretization(),
                   {{{1, pairs.discretization(), pairs.stress(), pairs.first().v}, pairs.first()}}) {
  second_ = &pairs.second();
  change_ = &pairs.change();
}

MembraneSums::MembraneSums(const Discretization& discrete, std::vector<Term> terms)
    : discrete_(discrete), terms_(std::move(terms)) {
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (QuadraticBalance(terms_[i].discrete).is_needed()) not_balanced_.push_back(i);
}

std::optional<QuadraticBalance::Data> MembraneSums::balance_on(int t) const {
  std::optional<Balance> sum;
  for (const std::size_t i : not_balanced_) {
    const auto own = QuadraticBalance(terms_[i].discrete)(t);
    if (own) sum = sum.value_or(Balance::Zero()) + terms_[i].factor * *own;
  }
  return sum;
}

LocalVector MembraneSums::stress_on(int t) const {
  LocalVector sum = LocalVector::Zero(terms_[0].stress.rows());
  for (const Term& term : terms_) sum += term.factor * term.stress.col(t);
  return sum;
}

Quadratic<1> MembraneSums::stream_function_on(int t) const {
  Quadratic<1> sum = Quadratic<1>::Zero();
  for (const Term& term : terms_) sum += term.factor * term.pair.stream_function_on(discrete_.mesh, t);
  return sum;
}

/// Where nothing is lifted.
TriangleSums MembraneSums::by_norms(int t, const MembraneNorms& norms, const Balance& balance) const {
  using Column = MembraneNorms::Column;
  constexpr int fluxes = QuadraticBalance::kFluxes;
  const Column stress = norms.stress.lazyProduct(stress_on(t));
  Column correction = norms.stream_function.lazyProduct(stream_function_on(t).transpose());
  correction += norms.balance.rightCols<Balance::RowsAtCompileTime - fluxes>().lazyProduct(
      balance.tail<Balance::RowsAtCompileTime - fluxes>());
  // On most triangles there are none.
  if (!balance.head<fluxes>().isZero(0))
    correction += norms.balance.leftCols<fluxes>().lazyProduct(balance.head<fluxes>());
  const Column strain = norms.strain.lazyProduct(displacement_on<1>(terms_, t).transpose()),
               direct_gap = stress - strain;
  TriangleSums sums;
  sums.gap = (direct_gap + correction).squaredNorm();
  sums.direct_gap = direct_gap.squaredNorm();
  sums.correction = correction.squaredNorm();
  sums.stress = stress.squaredNorm();
  sums.strain = sums.energy = strain.squaredNorm() / 2;
  return sums;
}

TriangleSums MembraneSums::by_points(int t, const std::optional<Balance>& balance, LawField<1>& law,
                                     const LawOnMesh& laws) const {
  const bool lifted = is_lifted(terms_, t), cubic = balance.has_value();
  const int of_fields =
      std::max(cubic ? 3 : discrete_.spaces().order + 1, lifted ? Lift::kDegreeInside - 1 : 1);
  const int of_load = lifted ? Lift::kDegreeInside + 2 : 0;
  TriangleSums sums;
  const std::vector<LawPiece> pieces = laws.cut(t);
  const auto degree_on = [&](const LawPiece& piece) {
    return std::max(of_load, piece.degree_of_rule(of_fields, laws.tolerance()));
  };
  if (pieces.empty()) {
    const int degree = degree_on(laws.whole(t));
    integrate(t, membrane_rule(discrete_.spaces(), degree), balance,
              laws.whole(t).error_of_rule(degree, of_fields), law, sums);
  }
  for (const LawPiece& piece : pieces) {
    const int degree = degree_on(piece);
    std::vector<WeightedPoint> points;
    for (const auto& [point, weight] : rule_of_degree(degree))
      points.push_back({piece.place(point), piece.place.share * weight});
    integrate(t, MembraneRule(discrete_.spaces(), std::move(points), cubic), balance,
              piece.error_of_rule(degree, of_fields), law, sums);
  }
  return sums;
}

TriangleSums MembraneSums::operator()(int t, LawField<1>& law, const LawOnMesh& laws) const {
  const AffineMap map(discrete_.mesh.corners(t));
  const std::optional<Balance> balance = balance_on(t);
  // Without one there are three points, or six.
  const MembraneNorms* const norms =
      balance && norms_ && !is_lifted(terms_, t) ? norms_->membrane(map, discrete_.spaces(), law) : nullptr;
  TriangleSums sums = norms ? by_norms(t, *norms, *balance) : by_points(t, balance, law, laws);

  // Πf is what counts but for the lifts: the rest of f is orthogonal to v, where that is quadratic.
  const ProjectedLoad load = load_on(terms_, t);
  const Quadratic<1> v = displacement_on<1>(terms_, t);
  const double area = map.determinant / 2, largest_value = bound_of_quadratic(v);
  sums.energy -= map.determinant * (v * quadratic_mass() * load.projection.transpose()).value();
  sums.energy_slack += load.uncertain_work * largest_value;
  const AdmissibleDisplacement::LiftRest rest = rest_of_lifts(terms_, t);
  if (rest.slope > 0) {
    const double zeta = rest.slope * std::sqrt(area * laws.whole(t).stiffest);
    sums.energy_slack += zeta * (std::sqrt(2 * sums.strain + sums.slack) + zeta / 2) +
                         rest.value * (std::sqrt(area) * load.rest + area * load.projection.norm());
    sums.add_unknown_strain(zeta);
  }
  sums.add_rounding(map, laws.whole(t), largest_value);
  return sums;
}

void MembraneSums::integrate(int t, const MembraneRule& rule, const std::optional<Balance>& balance,
                             double error, LawField<1>& law, TriangleSums& sums) const {
  const AffineMap map(discrete_.mesh.corners(t));
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  const Quadratic<1> v = displacement_on<1>(terms_, t);
  const Quadratic<1> stream_function = stream_function_on(t);
  const LocalVector stress = stress_on(t);
  Quadratic<1> w = Quadratic<1>::Zero(), stream_function_of_tau = Quadratic<1>::Zero();
  if (second_) {
    w = v - second_->v.on<1>(t);
    stream_function_of_tau = stream_function - second_->stream_function_on(discrete_.mesh, t);
  }
  const ProjectedLoad load = load_on(terms_, t);
  const bool curled = !stream_function.isZero(0), lifted = is_lifted(terms_, t);
  double lifted_square = 0;
  for (int q = 0; q < static_cast<int>(rule.points.size()); ++q) {
    const auto& [reference, share] = rule.points[q];
    const auto& [compliance, stiffness] = law(map(reference));
    const double weight = share * map.determinant;
    const Tensor<1> sigma = rule.stress(q, map, stress);
    Tensor<1> slope = gradient<1>(inverse, v * rule.gradients[q].transpose());
    if (lifted) {
      Eigen::Matrix<double, 1, 1> lift = Eigen::Matrix<double, 1, 1>::Zero();
      add_lifts<1>(terms_, t, reference, inverse, lift, slope);
      sums.energy -= weight * (load.projection * rule.basis[q]).value() * lift[0];
      lifted_square += weight * lift[0] * lift[0];
    }
    Tensor<1> correction = Tensor<1>::Zero();
    if (curled) correction = curl(inverse, stream_function * rule.gradients[q].transpose());
    if (change_) correction += rule.stress(q, map, change_->col(t));
    if (balance) correction += map.jacobian * (rule.balance[q] * *balance) / map.determinant;
    const Tensor<1> direct_gap = compliance * sigma - slope, gap = direct_gap + compliance * correction;
    const double of_strain = weight * slope.dot(stiffness * slope),
                 of_correction = weight * correction.dot(compliance * correction),
                 of_sigma = weight * sigma.dot(compliance * sigma);
    sums.gap += weight * gap.dot(stiffness * gap);
    sums.direct_gap += weight * direct_gap.dot(stiffness * direct_gap);
    sums.correction += of_correction;
    sums.stress += of_sigma;
    sums.strain += of_strain / 2;
    sums.energy += of_strain / 2;
    double all_fields = 2 * of_sigma + 3 * of_correction + of_strain;
    if (second_) {
      const Tensor<1> strain = gradient<1>(inverse, w * rule.gradients[q].transpose()),
                      moved = stiffness * strain,
                      tau = curl(inverse, stream_function_of_tau * rule.gradients[q].transpose());
      const double of_moved = weight * strain.dot(moved);
      sums.span += weight * (moved + tau).dot(compliance * (moved + tau));
      sums.along += weight * (moved + tau).dot(compliance * correction);
      sums.known += weight * gap.dot(moved - tau);
      sums.moved += of_moved;
      all_fields += 2 * of_moved + 2 * weight * tau.dot(compliance * tau);
    }
    sums.slack += 2 * error * all_fields;
    sums.energy_slack += error * of_strain;
  }
  sums.energy_slack += load.rest * std::sqrt(lifted_square);
}

}  // namespace signorini
