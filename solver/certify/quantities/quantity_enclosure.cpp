#include "certify/quantities/quantity_enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/pressure/contact_terms.hpp"
#include "certify/rounding.hpp"
#include "certify/traction_work.hpp"
#include "certify/triangle_sums.hpp"

namespace signorini {
namespace {

/// ‖·‖ of what adds o_T to a field of the given squares, by triangles.
double norm_with(const Eigen::VectorXd& squares, const Eigen::VectorXd& o) {
  return (squares.cwiseSqrt() + o).norm();
}

}  // namespace

template <int D>
QuantityEnclosure::Sums QuantityEnclosure::sums_of(const Discretization& loads,
                                                   const std::vector<Term>& terms) const {
  using FieldSums = std::conditional_t<D == 1, MembraneSums, ElasticSums>;
  std::vector<typename FieldSums::Term> all;
  for (const Term& term : terms) {
    const CertifiedSolution& own = term.solution;
    const PairTerm pair{term.of_displacement, term.of_stress, own.discrete, own.stress, own.pair.v};
    if constexpr (D == 1)
      all.push_back({pair, own.pair});
    else
      all.push_back({pair, *own.pair.tractions});
  }
  FieldSums fields(loads, std::move(all));
  LawField<D> law(loads.problem.material);
  Sums sums{Eigen::VectorXd(loads.triangles())};
  for (int t = 0; t < loads.triangles(); ++t) {
    progress_.check_in(t);
    const TriangleSums own = fields(t, law, laws_);
    sums.gaps[t] = own.gap + own.slack;
    sums.gap += own.gap;
    sums.strain += own.strain;
    sums.energy += own.energy;
    sums.slack += own.slack;
    sums.energy_slack += own.energy_slack;
  }
  return sums;
}

QuantityEnclosure::Sums QuantityEnclosure::sums(const Discretization& loads,
                                                const std::vector<Term>& terms) const {
  return loads.spaces().components == 1 ? sums_of<1>(loads, terms) : sums_of<2>(loads, terms);
}

QuantityEnclosure::QuantityEnclosure(const CertifiedSolution& base, const LawOnMesh& laws, Progress& progress)
    : base_(base),
      laws_(laws),
      progress_(progress),
      everywhere_(base.discrete.triangles(), 0),
      own_(sums(base.discrete, {{1, 1, base}})),
      contact_(contact_work(base)) {
  const double gap = norm_with(own_.gaps, base.oscillations) + base.carried();
  const double contact = std::max(0., contact_.value + contact_.radius) * (1 + base.loads.change_of_pressure);
  radius_ = std::sqrt(gap * gap + 4 * contact);
}

/// ∫ p* (g − v_n), with p* of another solution.
QuantityEnclosure::Known QuantityEnclosure::contact_work(const CertifiedSolution& of_pressure) const {
  const ContactPressure& pressure = of_pressure.pair.pressure;
  Known sum;
  CellBudget budget{ContactTerms::kCells, &progress_};
  const int edges = static_cast<int>(base_.discrete.clearance.edges.size());
  for (int i = 0; i < edges; ++i) {
    if (pressure.at_ends[i][0] == 0 && pressure.at_ends[i][1] == 0) continue;
    budget.share(edges - i, [&](CellBudget& own) {
      const auto [value, radius] =
          ContactTerms(base_.discrete, base_.pair.v, i, own).work(pressure, base_.pair.v);
      sum += {value, radius};
    });
  }
  return sum;
}

QuantityEnclosure::Known QuantityEnclosure::work_of_traction(const Discretization& loads,
                                                             const AdmissibleDisplacement& v) const {
  const TractionWork work = signorini::work_of_traction(loads, v, everywhere_);
  return {work.value, work.slack + kRoundingOfSums * work.size};
}

/// (f, v) + <t, v>, with the sums of v and these loads.
QuantityEnclosure::Known QuantityEnclosure::work_of_loads(const Discretization& loads,
                                                          const Sums& of_v) const {
  Known sum{of_v.strain - of_v.energy, of_v.energy_slack + kRoundingOfSums * std::abs(of_v.strain)};
  sum += work_of_traction(loads, base_.pair.v);
  return sum;
}

/// By what the stresses may differ that make up for what is not balanced: of loads that are the same they are
/// the same. Adds what is on single triangles to o, answers the rest.
double QuantityEnclosure::unbalanced_between(const CertifiedSolution& other, bool have_same_loads,
                                             Eigen::VectorXd& o) const {
  const auto depends_on_pressure = [](const CertifiedSolution& own) {
    return !own.pair.pressure.steep.empty() || !own.pair.pressure.lacks.empty() ||
           own.loads.change_of_pressure > 0;
  };
  if (have_same_loads && !depends_on_pressure(base_) && !depends_on_pressure(other)) return 0;
  o += base_.oscillations + other.oscillations;
  return base_.carried() + other.carried();
}

/// z Q as far as it is known, and by how much it may differ, for the way (v₂ − v, σ₂ − σ*) that the three
/// terms add up to: start is a multiple of the base. THEORY.md, Theorem 4.
QuantityEnclosure::Known QuantityEnclosure::along(const Quantity& quantity, const Term& start,
                                                  const Term& of_stress, const Term& of_displacement,
                                                  double& x, Eigen::VectorXd& shares) const {
  const Sums way = sums(base_.discrete, {start, of_stress, of_displacement}),
             end = sums(base_.discrete, {start + 1, of_stress, of_displacement});
  Known sum;
  // −J'(v) (v₂ − v).
  sum += {own_.strain - end.strain + 2 * way.strain - way.energy,
          own_.slack + end.slack + 2 * way.slack + way.energy_slack +
              kRoundingOfSums * (own_.strain + end.strain + std::abs(way.energy))};
  sum += start.of_displacement * work_of_traction(base_.discrete, base_.pair.v);
  sum += of_displacement.of_displacement * work_of_traction(base_.discrete, of_displacement.solution.pair.v);
  // The work on v of what the loads differ by.
  const bool have_same_loads = quantity.has_no_loads();
  if (!have_same_loads) {
    const Discretization& loads = of_stress.solution.discrete;
    sum += of_stress.of_stress * work_of_loads(loads, sums(loads, {{1, 1, base_}}));
    sum += -of_stress.of_stress * work_of_loads(base_.discrete, own_);
  }
  const Known of_other = contact_work(of_stress.solution);
  sum += of_stress.of_stress * of_other;
  sum += start.of_stress * contact_;
  sum.radius += base_.loads.change_of_pressure * contact_.value +
                of_stress.solution.loads.change_of_pressure * of_other.value;
  // ½ (C σ* − ε(v), C (σ₂ − σ*) − ε(v₂ − v))_E.
  sum += {(end.gap - own_.gap - way.gap) / 4,
          (end.slack + own_.slack + way.slack) / 4 + kRoundingOfSums * (end.gap + own_.gap)};

  Eigen::VectorXd o = Eigen::VectorXd::Zero(base_.discrete.triangles());
  const double carried = unbalanced_between(of_stress.solution, have_same_loads, o);
  x = norm_with(way.gaps, o) + carried;
  shares = (own_.gaps.cwiseSqrt() + base_.oscillations).cwiseProduct(way.gaps.cwiseSqrt() + o);
  sum.radius += (base_.unbalanced() * x + std::sqrt(own_.gaps.sum()) * (o.norm() + carried)) / 2;
  // d x + s is at most this for all d² + s ≤ R²/4.
  sum.radius += radius_ <= x ? radius_ * x / 2 : (radius_ * radius_ + x * x) / 4;
  return sum;
}

/// From above by the way to the stress of one neighbour and from the displacement of the other, from below
/// the other way round.
QuantityEnclosure::Bounds QuantityEnclosure::operator()(const Quantity& quantity,
                                                        const CertifiedSolution& plus,
                                                        const CertifiedSolution& minus, double z) const {
  Eigen::VectorXd of_above, of_below;
  double x_above = 0, x_below = 0;
  const Known above = along(quantity, {1, -1, base_}, {0, 1, plus}, {-1, 0, minus}, x_above, of_above),
              below = along(quantity, {-1, 1, base_}, {0, -1, minus}, {1, 0, plus}, x_below, of_below);
  return {(below.value - below.radius) / z, (above.value + above.radius) / z, std::max(x_above, x_below),
          of_above + of_below};
}

QuantityEnclosure::Bounds QuantityEnclosure::reflected(const Quantity& quantity,
                                                       const CertifiedSolution& plus, double z) const {
  Eigen::VectorXd shares;
  double x = 0;
  const Known both = along(quantity, {-1, -1, base_}, {0, 1, plus}, {1, 0, plus}, x, shares);
  return {(both.value - both.radius) / z, (both.value + both.radius) / z, x, std::move(shares)};
}

}  // namespace signorini
