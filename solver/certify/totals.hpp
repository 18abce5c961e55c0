#pragma once

#include <optional>
#include <string>

#include "certify/data/carried_loads.hpp"
#include "certify/pair_sums.hpp"
#include "certify/triangle_sums.hpp"

namespace signorini {

/// Of each triangle of a mesh, the triangle of the whole that it belongs to; -1 if others stand for it.
using Owners = std::vector<int>;

/// The sums over some triangles.
struct TriangleTotals {
  /// Adds a triangle with the oscillation o on it, and finds its share.
  void add(const TriangleSums& own, double o, double& share);
  TriangleTotals& operator+=(const TriangleTotals& other);

  TriangleSums all;
  double oscillation_square = 0, rounding_square = 0;
  double balanced_gap = 0, balanced_correction = 0;  ///< Σ (‖e − b‖ + o)² and Σ (‖δ‖ + o)², o with rounding
};

/// The sums over all triangles and over Γ_C, and the shares of the triangles of the whole.
struct Totals : TriangleTotals {
  explicit Totals(int triangles) : shares(Eigen::VectorXd::Zero(triangles)) {}

  /// Adds the triangles that have owners. `sums` are those of the pair, and of the second one if there is
  /// one: MembraneSums or ElasticSums. `of_all`: what all triangles are added to.
  template <int D, typename Sums>
  void add(const Discretization& discrete, const LawOnMesh& laws, const AdmissiblePair& pair,
           const Sums& sums, const Owners& owners, Progress& progress, const AdmissiblePair* second = nullptr,
           PairSums* of_all = nullptr);

  /// Adds what carries the uncertain loads, after all triangles.
  void add(const CarriedLoads& loads);

  double contact = 0;
  double work = 0;     ///< |∫ t·v| with all signs taken as one: what rounding is measured by
  double carried = 0;  ///< the norm of the stress that carries uncertain loads
  std::optional<std::string> endless_gap;  ///< where p* acts on a gap that is not known to be finite
  /// The second pair is one with the same uncertain loads: not if p* had to change for them.
  bool second_counts = true;
  Eigen::VectorXd shares;
};

/// The least of ‖δ − θ s‖ R + θ K over θ ∈ [0, 1], from ‖δ‖², ‖s‖², (s, δ) and K, each of which may be larger
/// by the slack.
double least_over_the_way(double delta_square, double s_square, double s_delta, double radius, double known,
                          double slack = 0);

/// The bound of THEORY.md, Theorems 2 and 3, whose proofs stand there: with G and D the norms of σ* − E ε(v)
/// and of σ* − sym σ_h, both with what makes up for the oscillation o_T of each triangle and for carried
/// loads, c = 2 <p*, g − v_n> and R² = G² + 2 c,
///
///     value²  =  c + (G² + D² + ‖sym σ_h − E ε(v)‖²) / 2 + min(D R, M) + ‖skew σ_h‖²,
///
/// M the least of least_over_the_way() against the second pair. The energies are J(v) and J(v) − (G² + c)
/// / 2.
///
/// Each sum counts with its slack in the direction that makes the bound larger.
ErrorBound bound_from(const Totals& totals);

/// Encloses the work of the loads, which for the discrete solution is the value: THEORY.md, section 9.
/// `at_rest`: fixed values and gaps are zero.
EnclosedNumber work_from(const Totals& totals, const ErrorBound& bound, double value, bool at_rest);

}  // namespace signorini
