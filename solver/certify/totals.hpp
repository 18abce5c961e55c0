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

/// With e = σ − σ*, b = E ε(u − v), δ = σ* − sym σ_h and the oscillation o, the identity of the pair (σ*, v):
///
///     ‖e‖² + ‖b‖² + 2 <p*, g − u_n> + 2 <p, g − v_n>  ≤  ‖e − b‖² + contact + 2 o ‖b‖  ≤  P²,
///
/// where e − b = E ε(v) − σ*; hence ‖e + b‖ ≤ R, R² = 2 P² − ‖e − b‖² (Prager, Synge 1947).
/// For the stress of the solution, sym σ_h = σ* − δ,
///
///     ‖e + δ‖² + ‖b‖²  ≤  P² − 2 <p*, g − u_n> − 2 <p, g − v_n> + ‖δ‖² + (e − b, δ) + (e + b, δ).
///
/// The last product is at most ‖δ‖ R. But against a second pair (σ*₂, v₂) the error is known. With w = v −
/// v₂, τ = σ* − σ*₂, which has the pressure π = p* − p₂*, and s = E ε(w) + τ it is, by parts,
///
///     (e + b, s)  =  (σ* − E ε(v), E ε(w) − τ) + 2 <p* − p, w_n> + 2 <π, v_n − u_n> + 2 (f − Πf, w)
///                 ≤  K + 2 <p*, g − u_n> + 2 <p, g − v_n>,
///     K  =  (σ* − E ε(v), E ε(w) − τ) + 2 <p*, w_n> − 2 <π, g − v_n> + 2 Σ o ‖ε(w)‖,
///
/// because p₂* ≥ 0 and v₂n ≤ g. So (e + b, δ) − 2 <p*, g − u_n> − 2 <p, g − v_n> ≤ ‖δ − s‖ R + K, and between
/// the two pairs the same holds for θ s and θ K. The skew part of σ_h is orthogonal to e + δ.
///
/// Each sum counts with its slack in the direction that makes the bound larger.
ErrorBound bound_from(const Totals& totals);

}  // namespace signorini
