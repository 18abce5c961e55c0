#pragma once

#include <cmath>

#include "certify/admissible_pair.hpp"
#include "certify/data/law_pieces.hpp"
#include "certify/elasticity/edge_tractions.hpp"
#include "certify/membrane/membrane_rule.hpp"
#include "certify/pair_term.hpp"
#include "certify/patches/patch_pairs.hpp"
#include "certify/shape_norms.hpp"
#include "certify/tensor.hpp"

namespace signorini {

/// What one triangle adds to the bound: δ = σ* − sym σ_h, and against a second pair w = v − v₂, τ = σ* − σ*₂.
struct TriangleSums {
  double gap = 0;         ///< ‖C σ* − ε(v)‖²_E
  double direct_gap = 0;  ///< ‖C sym σ_h − ε(v)‖²_E
  double correction = 0;  ///< ‖δ‖²_C
  double skew = 0;        ///< ‖skew σ_h‖²_C
  double stress = 0;      ///< ‖σ_h‖²_C
  double energy = 0;      ///< ½ ‖ε(v)‖²_E − (Πf, v)
  double strain = 0;      ///< ½ ‖ε(v)‖²_E
  double span = 0;        ///< ‖E ε(w) + τ‖²_C
  double along = 0;       ///< (E ε(w) + τ, δ)_C
  double known = 0;       ///< (σ* − E ε(v), E ε(w) − τ)_C
  double moved = 0;       ///< ‖ε(w)‖²_E

  /// What each of the above, and every product of its fields, may be off by at most: for the law is no
  /// polynomial, and of some of v there is but a bound.
  double slack = 0;
  double energy_slack = 0;  ///< and ½ ‖ε(v)‖²_E − (f, v)
  /// What rounding changes of a field, in its norm: on one triangle.
  double rounding = 0;

  TriangleSums& operator+=(const TriangleSums& other);
  /// Strains of the norm ζ in v that are not among the sums.
  void add_unknown_strain(double zeta);
  /// That of fields made of a displacement with values of at most this size, on the triangle of the map.
  void add_rounding(const AffineMap& map, const LawPiece& law, double largest_value);
  double norm_of_gap() const { return std::sqrt(gap + slack) + rounding; }
};

/// Membrane: σ* is σ_h, the quadratic balance, and the curl of the stream function of both it and the
/// pressure; v is v_h. On a patch σ* has a change of its own besides, and there is a second pair.
///
/// v, σ* and the load may be sums of those of several pairs on one mesh, all but the first times a number.
///
/// The rules are exact for what is integrated with a law that is a polynomial of some degree. What it has
/// beyond that counts twice, in the integral and in the rule, whose weights are positive.
class MembraneSums {
 public:
  struct Term : PairTerm {
    const AdmissiblePair& pair;
  };

  MembraneSums(const Discretization& discrete, const Eigen::MatrixXd& stress, const AdmissiblePair& pair,
               ShapeNorms& norms);
  /// `norms`, those of the same law, must outlive this.
  MembraneSums(const Discretization& discrete, std::vector<Term> terms, ShapeNorms& norms);
  explicit MembraneSums(const PatchPairs& pairs);

  TriangleSums operator()(int t, LawField<1>& law, const LawOnMesh& laws) const;

 private:
  using Balance = QuadraticBalance::Data;

  MembraneSums(const Discretization& discrete, std::vector<Term> terms);

  std::optional<Balance> balance_on(int t) const;
  LocalVector stress_on(int t) const;
  Quadratic<1> stream_function_on(int t) const;
  TriangleSums by_norms(int t, const MembraneNorms& norms, const Balance& balance) const;
  void integrate(int t, const MembraneRule& rule, const std::optional<Balance>& balance, double error,
                 LawField<1>& law, TriangleSums& sums) const;
  TriangleSums by_points(int t, const std::optional<Balance>& balance, LawField<1>& law,
                         const LawOnMesh& laws) const;

  const Discretization& discrete_;
  std::vector<Term> terms_;
  std::vector<std::size_t> not_balanced_;   ///< terms whose σ_h is not by itself, on all triangles
  ShapeNorms* norms_ = nullptr;             ///< of a patch none
  const AdmissiblePair* second_ = nullptr;  ///< against that of the only term
  const Eigen::MatrixXd* change_ = nullptr;
};

/// Elastic body: σ* is the symmetric stress on the macro-element that has the tractions of EdgeTractions, is
/// in equilibrium with the discrete load and lies nearest to σ_h. v is v_h, quadratic on each part of the
/// macro-element, where the values inside the triangle minimise ‖C σ* − ε(v)‖_E: as ν → 1/2 its divergence
/// follows that of the stress, because the mean over the edges of v_h balances the volume.
///
/// v and σ* may be sums of those of several pairs, as for MembraneSums: what v is inside the macro-elements
/// is linear in them.
class ElasticSums {
 public:
  struct Term : PairTerm {
    const EdgeTractions& tractions;
  };

  /// Of several pairs: `gap`, `strain`, `stress` and `energy` alone. `norms`, those of the same law, must
  /// outlive this.
  ElasticSums(const Discretization& discrete, std::vector<Term> terms, ShapeNorms& norms);
  ElasticSums(const Discretization& discrete, const Solution& solution, const AdmissibleDisplacement& v,
              const EdgeTractions& tractions, ShapeNorms& norms);

  TriangleSums operator()(int t, LawField<2>& law, const LawOnMesh& laws);

 private:
  using Given = JohnsonMercierFields<1>::Given;

  using Inner = Eigen::Matrix<double, 2 * JohnsonMercierRule::kInner, 1>;

  /// What is found of a triangle, maybe along with an earlier one.
  struct Found {
    int triangle = -1;
    TriangleSums sums;
    Inner inner = Inner::Zero();
    /// Where something is lifted: (Πf, it), and the square of what v is beside v_h.
    double work_on_lifts = 0, rest_square = 0;
  };

  /// By the points of a rule; empty if nothing is lifted.
  struct Lifted {
    std::vector<Eigen::Vector2d> values;
    std::vector<Eigen::Vector3d> strains;
  };
  struct OnRule {
    const JohnsonMercierRule& rule;
    std::vector<SymmetricLaw> laws;
    Lifted lifted;
    JohnsonMercierFields<1>::Values values;
  };

  /// So many triangles are looked at for others of the same shape.
  static constexpr int kAhead = 128;

  Given given_on(int t, const AffineMap& map) const;
  const Found& by_norms(int t, const JohnsonMercierNorms& norms);
  Found by_points(int t, const AffineMap& map, std::span<const LawPiece> pieces, int of_fields,
                  LawField<2>& law, const LawOnMesh& laws);
  void add_points(int t, const AffineMap& map, const OnRule& on, double error_of_whole, Found& found) const;
  Lifted lifted_on(int t, const AffineMap& map, const JohnsonMercierRule& rule) const;
  void add_work_of_load(int t, const AffineMap& map, const Quadratic<2>& displacement, const Found& found,
                        TriangleSums& sums) const;
  void add_rest_of_lifts(int t, const AffineMap& map, const LawPiece& law, TriangleSums& sums) const;

  const Discretization& discrete_;
  std::vector<Term> terms_;
  const bool has_load_;
  bool needs_all_ = false;
  ShapeNorms& norms_;
  std::array<Found, kAhead> found_;    ///< that of a triangle by its number's rest
  JohnsonMercierRule rule_of_pieces_;  ///< of the last triangle that was cut: its room is used again
};

}  // namespace signorini
