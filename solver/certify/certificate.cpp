#include "certify/certificate.hpp"

#include <cmath>

#include "certify/least_potential.hpp"
#include "certify/oscillation.hpp"
#include "certify/triangle_sums.hpp"

namespace signorini {
namespace {

/// 2 ∫ p* (g − v_n) over a contact edge.
double contact_term(const Discretization& problem, const AdmissibleDisplacement& v,
                    const ContactPressure& pressure, int i) {
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

/// ∫ t·v over Γ_F.
double work_of_traction(const Discretization& problem, const AdmissibleDisplacement& v) {
  const TractionField traction(problem.problem, problem.mesh);
  double sum = 0;
  for (int edge = 0; edge < static_cast<int>(problem.mesh.edges.size()); ++edge) {
    if (!traction.acts_on(edge)) continue;
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const Eigen::VectorXd value = v.on_edge(edge, s);
      for (int c = 0; c < problem.spaces().components; ++c)
        sum += edge_rule().weights[q] * problem.mesh.length(edge) * traction(edge, c, s) * value[c];
    }
  }
  return sum;
}

/// The sums over all triangles and over Γ_C, and their shares.
template <int D, typename Sums>
struct Totals {
  Totals(const Discretization& problem, const AdmissibleDisplacement& v, const ContactPressure& pressure,
         Sums sums, Progress& progress)
      : shares(problem.triangles()) {
    LawField<D> law(problem.problem.material);
    LoadValues<D> load(problem);
    const Oscillation<D> oscillation(problem);
    for (int t = 0; t < problem.triangles(); ++t) {
      progress.check_in(t);
      const TriangleSums own = sums(t, law, load);
      all += own;
      const double o = oscillation(t, law, load);
      oscillation_square += o * o;
      shares[t] = own.gap + own.correction + own.skew + o * o;
    }
    for (int i = 0; i < static_cast<int>(problem.clearance.edges.size()); ++i) {
      const double own = contact_term(problem, v, pressure, i);
      contact += own;
      shares[problem.mesh.edge_triangles[problem.clearance.edges[i].edge][0]] += own;
    }
    all.energy -= work_of_traction(problem, v);
  }

  TriangleSums all;
  double contact = 0, oscillation_square = 0;
  Eigen::VectorXd shares;
};

/// With e = σ − σ*, b = E ε(u − v), δ = σ* − sym σ_h and the oscillation o, the identity of σ* is
///
///     ‖e‖² + ‖b‖² + contact terms  ≤  ‖e − b‖² + contact + 2 o ‖b‖  ≤  P²,   e − b = E ε(v) − σ*,
///
/// hence ‖e + b‖² ≤ 2 P² − ‖e − b‖² (Prager, Synge 1947). For sym σ_h = σ* − δ that is
///
///     ‖e + δ‖² + ‖b‖² + contact terms  ≤  P² + ‖δ‖² + 2 (e, δ),   2 e = (e + b) + (e − b),
///
/// and the skew part of σ_h is orthogonal to e + δ.
template <typename Totals>
ErrorBound bound_from(const Totals& totals) {
  const auto& [gap, direct_gap, correction, skew, stress, energy] = totals.all;
  ErrorBound bound;
  bound.parts = {std::sqrt(gap), std::sqrt(totals.contact), std::sqrt(totals.oscillation_square),
                 std::sqrt(correction), std::sqrt(skew)};
  const double of_pair =
      bound.parts.oscillation + std::sqrt(totals.oscillation_square + gap + totals.contact);
  const double p_square = of_pair * of_pair;
  // (e − b, δ) from ‖e − b + δ‖² = ‖E ε(v) − sym σ_h‖².
  const double along = bound.parts.equilibration * std::sqrt(2 * p_square - gap),
               across = (direct_gap - gap - correction) / 2;
  bound.value = std::sqrt(p_square + correction + along + across + skew);
  const double of_stress = std::sqrt(stress);
  bound.relative = of_stress > 0 ? bound.value / of_stress : (bound.value > 0 ? 1 : 0);
  bound.energy_upper = energy;
  bound.energy_lower = energy - p_square / 2;
  return bound;
}

void add(std::vector<std::string>& all, const std::vector<std::string>& some) {
  all.insert(all.end(), some.begin(), some.end());
}

}  // namespace

Certificate certify(const Discretization& problem, const Solution& solution, const Eigen::VectorXd& coupling,
                    Progress& progress) {
  AdmissibleDisplacement v(problem, solution, coupling);
  if (problem.spaces().components == 1) v.relax(coupling, progress);
  const Eigen::VectorXd clearance =
      problem.clearance.clearance(coupling.tail(problem.traces.contact_unknowns()));
  ContactPressure pressure(problem, solution.stress, clearance);
  Certificate certificate;
  std::vector<std::string> unmet = v.unmet();
  add(unmet, pressure.unmet);
  // Rounding leaves less; an iteration that its tolerance ended before leaves more.
  constexpr double equilibrium = 1e-9;
  if (solution.summary.residuals.equilibrium > equilibrium)
    unmet.push_back("the stress is not in equilibrium: the iteration ended before it was");
  const auto finish = [&](auto&& totals) {
    certificate.bound = bound_from(totals);
    certificate.squares = std::move(totals.shares);
  };
  if (problem.spaces().components == 1) {
    minimize_potential(problem, v, clearance, pressure, progress);
    finish(Totals<1, MembraneSums>(problem, v, pressure, MembraneSums(problem, solution, v, pressure),
                                   progress));
  } else {
    const EdgeTractions tractions(problem, solution.stress, pressure);
    add(unmet, tractions.unmet());
    progress.check();
    finish(
        Totals<2, ElasticSums>(problem, v, pressure, ElasticSums(problem, solution, v, tractions), progress));
  }
  certificate.bound.unmet = std::move(unmet);
  certificate.bound.guaranteed = certificate.bound.unmet.empty();
  return certificate;
}

}  // namespace signorini
