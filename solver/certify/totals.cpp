#include "certify/totals.hpp"

#include <algorithm>
#include <cmath>

#include "certify/oscillation.hpp"

namespace signorini {
namespace {

/// 2 ∫ p* (g − v_n) over edge i of the clearance space.
double contact_term(const Discretization& problem, const ContactPressure& pressure,
                    const AdmissibleDisplacement& v, int i) {
  const ContactEdge& contact = problem.clearance.edges[i];
  const auto& [first, second] = pressure.at_ends[i];
  if (first == 0 && second == 0) return 0;
  double sum = 0;
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    sum += edge_rule().weights[q] * ((1 - s) * first + s * second) * std::max(0., v.room(contact, s));
  }
  return 2 * sum * problem.mesh.length(contact.edge);
}

/// ∫ t·v over Γ_F where the triangles have owners.
double work_of_traction(const Discretization& problem, const AdmissibleDisplacement& v,
                        const Owners& owners) {
  const TractionField traction(problem.problem, problem.mesh);
  double sum = 0;
  for (int edge = 0; edge < static_cast<int>(problem.mesh.edges.size()); ++edge) {
    if (!traction.acts_on(edge) || owners[problem.mesh.edge_triangles[edge][0]] < 0) continue;
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const Eigen::VectorXd value = v.on_edge(edge, s);
      for (int c = 0; c < problem.spaces().components; ++c)
        sum += edge_rule().weights[q] * problem.mesh.length(edge) * traction(edge, c, s) * value[c];
    }
  }
  return sum;
}

}  // namespace

template <int D, typename Sums>
void Totals::add(const Discretization& problem, const LoadValues<D>& load, const AdmissiblePair& pair,
                 Sums sums, const Owners& owners, Progress& progress, const AdmissiblePair* second) {
  LawField<D> law(problem.problem.material);
  const Oscillation<D> oscillation_on(problem);
  for (int t = 0; t < problem.triangles(); ++t) {
    progress.check_in(t);
    if (owners[t] < 0) continue;
    const TriangleSums own = sums(t, law, load);
    const double o = oscillation_on(t, law, load);
    all += own;
    all.known += 2 * o * std::sqrt(own.moved);
    oscillation_square += o * o;
    shares[owners[t]] += own.gap + own.correction + own.skew + o * o;
  }
  for (int i = 0; i < static_cast<int>(problem.clearance.edges.size()); ++i) {
    const int owner = owners[problem.mesh.edge_triangles[problem.clearance.edges[i].edge][0]];
    if (owner < 0) continue;
    const double own = contact_term(problem, pair.pressure, pair.v, i);
    contact += own;
    shares[owner] += own;
    if (second)
      all.known += contact_term(problem, pair.pressure, second->v, i) +
                   contact_term(problem, second->pressure, pair.v, i) - 2 * own;
  }
  all.energy -= work_of_traction(problem, pair.v, owners);
}

template void Totals::add<1>(const Discretization&, const LoadValues<1>&, const AdmissiblePair&, MembraneSums,
                             const Owners&, Progress&, const AdmissiblePair*);
template void Totals::add<2>(const Discretization&, const LoadValues<2>&, const AdmissiblePair&, ElasticSums,
                             const Owners&, Progress&, const AdmissiblePair*);

double least_over_the_way(double delta_square, double s_square, double s_delta, double radius, double known) {
  double theta = known < 0 && s_square > 0 ? 1 : 0;
  if (const double steepest = radius * radius * s_square; steepest > known * known) {
    const double middle = s_delta / s_square, least_square = std::max(0., delta_square - middle * s_delta);
    const double back = known * std::sqrt(least_square / (s_square * (steepest - known * known)));
    theta = std::clamp(middle - back, 0., 1.);
  }
  const double square = delta_square - 2 * theta * s_delta + theta * theta * s_square;
  return std::sqrt(std::max(0., square)) * radius + theta * known;
}

ErrorBound bound_from(const Totals& totals) {
  const TriangleSums& sums = totals.all;
  ErrorBound bound;
  bound.parts = {std::sqrt(sums.gap), std::sqrt(totals.contact), std::sqrt(totals.oscillation_square),
                 std::sqrt(sums.correction), std::sqrt(sums.skew)};
  const double of_pair =
      bound.parts.oscillation + std::sqrt(totals.oscillation_square + sums.gap + totals.contact);
  const double p_square = of_pair * of_pair;
  const double along = least_over_the_way(sums.correction, sums.span, sums.along,
                                          std::sqrt(2 * p_square - sums.gap), sums.known);
  // (e − b, δ) from ‖e − b + δ‖² = ‖E ε(v) − sym σ_h‖².
  const double across = (sums.direct_gap - sums.gap - sums.correction) / 2;
  bound.value = std::sqrt(p_square + sums.correction + across + along + sums.skew);
  const double of_stress = std::sqrt(sums.stress);
  bound.relative = of_stress > 0 ? bound.value / of_stress : (bound.value > 0 ? 1 : 0);
  bound.energy_upper = sums.energy;
  bound.energy_lower = sums.energy - p_square / 2;
  return bound;
}

}  // namespace signorini
