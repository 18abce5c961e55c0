#pragma once

#include "certify/triangle_sums.hpp"

namespace signorini {

/// Of each triangle of a mesh, the triangle of the whole that it belongs to; -1 if others stand for it.
using Owners = std::vector<int>;

/// The sums over all triangles and over Γ_C, and the shares of the triangles of the whole.
struct Totals {
  explicit Totals(int triangles) : shares(Eigen::VectorXd::Zero(triangles)) {}

  /// Adds the triangles that have owners. `sums` are those of the pair, and of the second one if there is
  /// one: MembraneSums or ElasticSums.
  template <int D, typename Sums>
  void add(const Discretization& problem, const LawOnMesh& laws, const AdmissiblePair& pair, Sums sums,
           const Owners& owners, Progress& progress, const AdmissiblePair* second = nullptr);

  TriangleSums all;
  double contact = 0, oscillation_square = 0;
  double balanced_gap = 0, balanced_correction = 0;  ///< Σ (‖e − b‖ + o)² and Σ (‖δ‖ + o)² over the triangles
  double work = 0;     ///< |∫ t·v| with all signs taken as one: what rounding is measured by
  double carried = 0;  ///< CarriedLoads::norm
  Eigen::VectorXd shares;

 private:
  template <int D>
  void add_work_of_traction(const Discretization& problem, const AdmissibleDisplacement& v, const Owners& owners);
};

/// The least of ‖δ − θ s‖ R + θ K over θ ∈ [0, 1], from ‖δ‖², ‖s‖², (s, δ) and K, each of which may be larger by the
/// slack.
double least_over_the_way(double delta_square, double s_square, double s_delta, double radius, double known,
                          double slack = 0);

/// What the balance of (σ*, v) lacks, f − Πf and t − Πt, some stress τ makes up for: on each triangle alone one with
/// ‖τ‖_T ≤ o_T, the oscillation (by duality, for ℓ(w) = (f − Πf, w) + <t − Πt, w> ≤ o_T ‖ε(w)‖_T is 0 on rigid motions:
/// τ = E ε(z) with (ε(z), E ε(w))_T = ℓ(w) for all w), and what carries uncertain loads, ‖τ‖ ≤ κ (carried_loads.hpp).
/// Nothing is known of τ but that. With e = σ − σ* − τ, b = E ε(u − v) and δ = σ* + τ − sym σ_h, the identity of the
/// pair (σ* + τ, v) is
///
///     ‖e‖² + ‖b‖² + 2 <p*, g − u_n> + 2 <p, g − v_n>  =  ‖e − b‖² + contact  ≤  P²,
///     ‖e − b‖ = ‖σ* + τ − E ε(v)‖  ≤  G = (Σ (‖σ* − E ε(v)‖_T + o_T)²)^{1/2} + κ,
///
/// hence ‖e + b‖ ≤ R, R² = 2 contact + G² (Prager, Synge 1947; the sum over triangles as in Braess, Schöberl 2008).
/// For the stress of the solution, sym σ_h = σ* + τ − δ, with ‖δ‖ ≤ D, of σ* − sym σ_h and o_T as G is,
///
///     ‖e + δ‖² + ‖b‖²  =  P² − 2 <p*, g − u_n> − 2 <p, g − v_n> + ‖δ‖² + (e − b, δ) + (e + b, δ),
///     (e − b, δ)  =  (‖sym σ_h − E ε(v)‖² − ‖e − b‖² − ‖δ‖²) / 2.
///
/// The last product is at most D R. But against a second pair (σ*₂ + τ, v₂) the error is known. With w = v −
/// v₂, η = σ* − σ*₂, which has the pressure π = p* − p₂*, and s = E ε(w) + η it is, by parts,
///
///     (e + b, s)  =  (σ* + τ − E ε(v), E ε(w) − η) + 2 <p* − p, w_n> + 2 <π, v_n − u_n>
///                 ≤  K + 2 <p*, g − u_n> + 2 <p, g − v_n>,
///     K  =  (σ* − E ε(v), E ε(w) − η) + 2 <p*, w_n> − 2 <π, g − v_n> + Σ (o_T + κ) (2 ‖ε(w)‖_T + ‖s‖_T),
///
/// because p₂* ≥ 0 and v₂n ≤ g. So (e + b, δ) − 2 <p*, g − u_n> − 2 <p, g − v_n> ≤ ‖δ − s‖ R + K, and between
/// the two pairs the same holds for θ s and θ K. The skew part of σ_h is orthogonal to e + δ.
///
/// Each sum counts with its slack in the direction that makes the bound larger.
ErrorBound bound_from(const Totals& totals);

}  // namespace signorini
