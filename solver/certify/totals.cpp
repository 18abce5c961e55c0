#include "certify/totals.hpp"

#include <algorithm>
#include <cmath>

#include "certify/data/oscillation.hpp"
#include "certify/pressure/contact_terms.hpp"
#include "certify/rounding.hpp"
#include "certify/traction_work.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

bool is_zero(const ContactPressure& pressure, int i) {
  return pressure.at_ends[i][0] == 0 && pressure.at_ends[i][1] == 0;
}

}  // namespace

void TriangleTotals::add(const TriangleSums& own, double o, double& share) {
  const double off = o + own.rounding;
  all += own;
  all.known += off * (2 * std::sqrt(own.moved + own.slack) + std::sqrt(own.span + own.slack));
  oscillation_square += o * o;
  rounding_square += own.rounding * own.rounding;
  const double of_gap = std::pow(own.norm_of_gap() + o, 2),
               of_correction = std::pow(std::sqrt(own.correction + own.slack) + off, 2);
  balanced_gap += of_gap;
  balanced_correction += of_correction;
  share = of_gap + of_correction + own.skew;
}

TriangleTotals& TriangleTotals::operator+=(const TriangleTotals& other) {
  all += other.all;
  oscillation_square += other.oscillation_square;
  rounding_square += other.rounding_square;
  balanced_gap += other.balanced_gap;
  balanced_correction += other.balanced_correction;
  return *this;
}

template <int D, typename Sums>
void Totals::add(const Discretization& discrete, const LawOnMesh& laws, const AdmissiblePair& pair,
                 const Sums& sums, const Owners& owners, Progress& progress, const AdmissiblePair* second,
                 PairSums* of_all) {
  const Eigen::VectorXd unbalanced = oscillations(discrete, load_remainders(discrete, owners, progress),
                                                  pair.pressure, laws, owners, progress);
  struct Found {
    Part part;
    TriangleTotals totals = {};
    PairTotals of_pair = {};
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(part.end - part.begin);
  };
  const auto find = [&](Part part, Progress& own_progress) {
    Found found{part};
    Sums on(sums);
    LawField<D> law(discrete.problem.material);
    for (int t = part.begin; t < part.end; ++t) {
      own_progress.check_in(t);
      if (owners[t] < 0 && !of_all) continue;
      const TriangleSums own = on(t, law, laws);
      if (of_all) {
        of_all->gaps[t] = gap_from_above(own);
        found.of_pair.add(own);
      }
      if (owners[t] >= 0) found.totals.add(own, unbalanced[t], found.shares[t - part.begin]);
    }
    return found;
  };
  in_parts(discrete.triangles(), progress, find, [&](const Found& found) {
    *this += found.totals;
    if (of_all) *of_all += found.of_pair;
    for (int t = found.part.begin; t < found.part.end; ++t)
      if (owners[t] >= 0) shares[owners[t]] += found.shares[t - found.part.begin];
  });
  CellBudget budget{ContactTerms::kCells, &progress};
  const int edges = static_cast<int>(discrete.clearance.edges.size());
  for (int i = 0; i < edges; ++i) {
    const int owner = owners[discrete.mesh.edge_triangles[discrete.clearance.edges[i].edge][0]];
    if (owner < 0) continue;
    if (is_zero(pair.pressure, i) && (!second || is_zero(second->pressure, i))) continue;
    std::optional<ContactTerms> of_edge;
    budget.share(edges - i, [&](CellBudget& part) { of_edge.emplace(discrete, pair.v, i, part); });
    const ContactTerms& terms = *of_edge;
    const double own = terms(pair.pressure, pair.v);
    if (!std::isfinite(own)) {
      const ContactEdge& edge = discrete.clearance.edges[i];
      endless_gap = gap_on(discrete, edge).name() + " is not known to be finite near " +
                    to_string(EdgeLine(discrete.mesh, edge.edge).at(0.5)) +
                    ", where the body presses on it: lower it there";
    }
    contact += own;
    shares[owner] += own;
    if (second) all.known += terms(pair.pressure, second->v) + terms(second->pressure, pair.v) - 2 * own;
  }
  const TractionWork of_traction = work_of_traction(discrete, pair.v, owners);
  all.energy -= of_traction.value;
  all.energy_slack += of_traction.slack;
  work += of_traction.size;
}

template void Totals::add<1>(const Discretization&, const LawOnMesh&, const AdmissiblePair&,
                             const MembraneSums&, const Owners&, Progress&, const AdmissiblePair*, PairSums*);
template void Totals::add<2>(const Discretization&, const LawOnMesh&, const AdmissiblePair&,
                             const ElasticSums&, const Owners&, Progress&, const AdmissiblePair*, PairSums*);

void Totals::add(const CarriedLoads& loads) {
  contact *= 1 + loads.change_of_pressure;
  second_counts = loads.change_of_pressure == 0;
  carried = loads.norm + loads.norm_on_patches;
}

double least_over_the_way(double delta_square, double s_square, double s_delta, double radius, double known,
                          double slack) {
  double theta = known < 0 && s_square > 0 ? 1 : 0;
  if (const double steepest = radius * radius * s_square; steepest > known * known) {
    const double middle = s_delta / s_square, least_square = std::max(0., delta_square - middle * s_delta);
    const double back = known * std::sqrt(least_square / (s_square * (steepest - known * known)));
    theta = std::clamp(middle - back, 0., 1.);
  }
  const double square = delta_square - 2 * theta * s_delta + theta * theta * s_square;
  return std::sqrt(std::max(0., square) + (1 + 2 * theta + theta * theta) * slack) * radius +
         theta * (known + slack);
}

ErrorBound bound_from(const Totals& totals) {
  const TriangleSums& sums = totals.all;
  ErrorBound bound;
  const double oscillation = std::sqrt(totals.oscillation_square) + totals.carried;
  bound.parts = {std::sqrt(sums.gap), std::sqrt(totals.contact), oscillation, std::sqrt(sums.correction),
                 std::sqrt(sums.skew)};
  const double gap = std::sqrt(totals.balanced_gap + sums.slack) + totals.carried,
               correction = std::sqrt(totals.balanced_correction + sums.slack) + totals.carried;
  const double p_square = gap * gap + totals.contact, radius = std::sqrt(p_square + totals.contact);
  const double known = sums.known + totals.carried * (2 * std::sqrt(sums.moved + sums.slack) +
                                                      std::sqrt(sums.span + sums.slack));
  const double rounding = std::sqrt(totals.rounding_square);
  double product = correction * radius;
  if (totals.second_counts)
    product = std::min(product,
                       least_over_the_way(sums.correction, sums.span, sums.along, radius, known, sums.slack) +
                           (oscillation + rounding) * radius);
  const double direct_gap = std::sqrt(sums.direct_gap) + rounding,
               skew = sums.skew > 0 ? std::sqrt(sums.skew) + rounding : 0;
  bound.value = std::sqrt(totals.contact +
                          (gap * gap + correction * correction + direct_gap * direct_gap + sums.slack) / 2 +
                          product + skew * skew + sums.slack);
  const double of_stress = std::sqrt(sums.stress);
  bound.relative = of_stress > 0 ? bound.value / of_stress : (bound.value > 0 ? 1 : 0);
  const double unknown =
      sums.energy_slack + kRoundingOfSums * (std::abs(sums.strain) + std::abs(sums.energy) + totals.work);
  bound.energy_upper = sums.energy + unknown;
  bound.energy_lower = sums.energy - unknown - p_square / 2;
  return bound;
}

EnclosedNumber work_from(const Totals& totals, const ErrorBound& bound, double value, bool at_rest) {
  if (at_rest) return enclosed_number(value, -2 * bound.energy_upper, -2 * bound.energy_lower);
  const TriangleSums& sums = totals.all;
  const double stress_on_strain = (sums.stress - sums.skew + 2 * sums.strain - sums.direct_gap) / 2,
               work_on_v = sums.strain - sums.energy;
  const double middle = stress_on_strain - work_on_v;
  const double off = 2 * sums.slack + sums.energy_slack +
                     kRoundingOfSums * (sums.stress + sums.strain + std::abs(sums.energy) + totals.work) +
                     bound.value * std::sqrt(2 * sums.strain + sums.slack);
  const double gap_square = 2 * (bound.energy_upper - bound.energy_lower);
  return enclosed_number(value, middle - off - 2 * bound.energy_upper - (gap_square + totals.contact) / 4,
                         middle + off - 2 * bound.energy_lower);
}

}  // namespace signorini
