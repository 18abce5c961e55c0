#pragma once

#include <span>
#include <vector>

#include "certify/data/law_pieces.hpp"
#include "certify/elasticity/johnson_mercier.hpp"
#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// Where the integrals over a macro-element are evaluated, with what does not depend on the triangle.
struct JohnsonMercierRule {
  /// Without any points.
  JohnsonMercierRule() = default;
  /// The rule of this degree on each part of the macro-element.
  JohnsonMercierRule(const Spaces& spaces, int degree);

  /// Makes it the rule that has on each piece of the triangle in each part of the macro-element what the
  /// piece needs for squares of fields of a degree, with the errors of the pieces. Takes pieces until they
  /// have enough points, and answers how many it took: all together may have tens of megabytes.
  std::size_t fill(const Spaces& spaces, std::span<const LawPiece> pieces, int of_fields, double tolerance);

  int size() const { return static_cast<int>(places.size()); }

  /// The inner nodes of the macro-element: those that are no nodes of P2 on the triangle.
  static constexpr int kInner = JohnsonMercier::kNodes - 6;

  struct Values {
    Eigen::Matrix<double, 3, JohnsonMercier::kFree> free;  ///< (xx, yy, xy) of the stresses without data
    Eigen::Matrix<double, 6, 1> basis;                     ///< of P2 on the triangle
    Eigen::Matrix<double, 2, 6> gradients;
    LocalVectors stress;  ///< of the row space
  };

  std::vector<JohnsonMercier::Place> places;
  std::vector<Values> values;
  std::vector<double> errors;  ///< LawPiece::error_of_rule by points; empty if the triangle was not cut

 private:
  void evaluate(const Spaces& spaces);
};

/// Integrals over the reference triangle of the functions at the inner nodes, times those of P2 on the
/// triangle and times each other.
struct InnerMass {
  Eigen::Matrix<double, 6, JohnsonMercierRule::kInner> with_quadratic;
  Eigen::Matrix<double, JohnsonMercierRule::kInner, JohnsonMercierRule::kInner> inner;
};
const InnerMass& inner_mass();

/// The rule of a degree of 6, 10, 18 or 30 for one of the two pairs of spaces, made once.
const JohnsonMercierRule& johnson_mercier_rule(const Spaces& spaces, int degree);

/// (xx, yy, √2 xy) of the symmetric part.
Eigen::Vector3d mandel(const Tensor<2>& tensor);

/// Mandel's tensor of J τ̂ Jᵀ / det J for τ̂ = (xx, yy, xy).
Eigen::Matrix3d piola(const AffineMap& map);

/// C on the symmetric tensors (xx, yy, √2 xy) of Mandel, by its factor C = L Lᵀ, and on skew ones.
struct SymmetricLaw {
  explicit SymmetricLaw(const Eigen::Matrix4d& compliance);

  Eigen::Matrix3d compliance, stiffness, factor;
  double skew_compliance;
};

/// The law at every point of the rule, or one for all if the material is constant.
std::vector<SymmetricLaw> laws_at(const Discretization& discrete, const JohnsonMercierRule& rule,
                                  const AffineMap& map, LawField<2>& law);

/// The stresses on a macro-element for any number of columns of what describes them: its data and the
/// coefficients of σ_h. Of those with the data it takes the one that is nearest to σ_h, by integrals over
/// rules that may have a part of the points each.
template <int Columns>
class JohnsonMercierStress {
 public:
  template <int Rows>
  using Block = Eigen::Matrix<double, Rows, Columns>;

  JohnsonMercierStress(const AffineMap& map, const Block<JohnsonMercier::kData>& data,
                       const Block<Eigen::Dynamic>& coefficients);

  /// By the points of a rule, tensors of Mandel: a stress with the data, and the symmetric part of σ_h
  /// itself.
  struct Values {
    std::vector<Block<3>> admissible, discrete;
    Block<Eigen::Dynamic> skew;  ///< of σ_h: a row a point
    bool are_nearest = false;
  };
  Values on(const JohnsonMercierRule& rule) const;

  /// Adds the integrals over a rule. The law at every point of it, or one for all.
  void add(const JohnsonMercierRule& rule, std::span<const SymmetricLaw> laws, const Values& values);
  /// After all rules: from now on stresses are the nearest.
  void minimize();
  /// Makes values of before so.
  void update(const JohnsonMercierRule& rule, Values& values) const;

  static constexpr int kFree = JohnsonMercier::kFree;
  /// The stresses without data, at a point.
  Eigen::Matrix<double, 3, kFree> free_at(const JohnsonMercierRule& rule, int q) const {
    return to_triangle_ * rule.values[q].free;
  }
  const Block<kFree>& free() const { return free_; }  ///< of the nearest

 private:
  AffineMap map_;
  Eigen::Matrix3d to_triangle_;
  Block<JohnsonMercier::kStresses> with_data_;
  Block<Eigen::Dynamic> coefficients_;
  Eigen::Matrix<double, kFree, kFree> matrix_ = decltype(matrix_)::Zero();
  Block<kFree> right_, free_;
  bool is_nearest_ = false;
};

/// √weight (σ* − the symmetric part of σ_h) in the norm of C, the rows of all points.
template <int Columns>
Eigen::Matrix<double, Eigen::Dynamic, Columns> correction(
    const JohnsonMercierRule& rule, const AffineMap& map,
    const typename JohnsonMercierStress<Columns>::Values& stress, std::span<const SymmetricLaw> laws);

/// The stresses and displacements on a macro-element for any number of columns of what describes them: the
/// data of the macro-element, the coefficients of σ_h, and v_h at the nodes of P2 (x and y in turns). The
/// stress is brought nearest to σ_h, and the strain of v, by its values at the inner nodes, to C σ*.
template <int Columns>
class JohnsonMercierFields {
 public:
  template <int Rows>
  using Block = Eigen::Matrix<double, Rows, Columns>;

  struct Given {
    Block<JohnsonMercier::kData> data;
    Block<Eigen::Dynamic> stress;
    Block<12> displacement;
  };

  JohnsonMercierFields(const AffineMap& map, const Given& given);

  struct Values {
    typename JohnsonMercierStress<Columns>::Values stress;
    std::vector<Block<3>> strain;  ///< of v, by points
    bool has_inner = false;
  };
  /// `lifted`: strains (Mandel) at the points that come to those of v_h; none if empty.
  Values on(const JohnsonMercierRule& rule, std::span<const Eigen::Vector3d> lifted) const;

  /// As JohnsonMercierStress does.
  void add(const JohnsonMercierRule& rule, std::span<const SymmetricLaw> laws, const Values& values);
  void minimize();
  void update(const JohnsonMercierRule& rule, Values& values) const;

  /// The values of v at the inner nodes beyond those of v_h.
  const Block<2 * JohnsonMercierRule::kInner>& inner() const { return inner_; }

 private:
  static constexpr int kInner = JohnsonMercierRule::kInner;

  AffineMap map_;
  JohnsonMercierStress<Columns> stress_;
  Block<12> displacement_;
  Eigen::Matrix<double, 2 * kInner, 2 * kInner> matrix_ = decltype(matrix_)::Zero();
  /// What the stresses without data change of the right side.
  Eigen::Matrix<double, 2 * kInner, JohnsonMercier::kFree> of_free_ = decltype(of_free_)::Zero();
  Block<2 * kInner> right_, inner_;
  bool has_inner_ = false;
};

/// What the bound integrates over a triangle. All is linear in the columns, so that those of the unit matrix
/// give the operators of a shape, and a single column the values of one triangle. Rows: of every point of a
/// rule, √weight times a tensor such that the square of the norm of a column is the integral.
template <int Columns>
struct JohnsonMercierOperators {
  template <int Rows>
  using Block = Eigen::Matrix<double, Rows, Columns>;

  /// Of the values when all is found. The law at every point of the rule, or one for all.
  JohnsonMercierOperators(const JohnsonMercierRule& rule, const AffineMap& map,
                          const typename JohnsonMercierFields<Columns>::Values& values,
                          std::span<const SymmetricLaw> laws);

  Block<Eigen::Dynamic> gap;         ///< C σ* − ε(v), in the norm of E
  Block<Eigen::Dynamic> direct_gap;  ///< C sym σ_h − ε(v), in the norm of E
  Block<Eigen::Dynamic> correction;  ///< σ* − the symmetric part of σ_h, in the norm of C
  Block<Eigen::Dynamic> skew;        ///< the skew part of σ_h, in the norm of C
  Block<Eigen::Dynamic> stress;      ///< σ_h, in the norm of C
  Block<Eigen::Dynamic> strain;      ///< ε(v), in the norm of E
};

/// The values of stresses or fields on a rule that is the only one. `lifted`: of fields.
template <typename Fields, typename... Lifted>
typename Fields::Values minimized(Fields& fields, const JohnsonMercierRule& rule,
                                  std::span<const SymmetricLaw> laws, const Lifted&... lifted) {
  typename Fields::Values values = fields.on(rule, lifted...);
  fields.add(rule, laws, values);
  fields.minimize();
  fields.update(rule, values);
  return values;
}

/// The same for all triangles of one shape and law, as triangular factors: the integrals are ‖gap z‖² with
/// z = (data, stress, displacement), and so on. Squares of norms keep the digits that a quadratic form of the
/// small difference of large numbers would lose.
struct JohnsonMercierNorms {
  JohnsonMercierNorms(const JohnsonMercierRule& rule, const AffineMap& map, const SymmetricLaw& law);

  Eigen::MatrixXd gap, direct_gap, strain;
  Eigen::MatrixXd correction;    ///< of (data, stress)
  Eigen::MatrixXd skew, stress;  ///< of stress
  Eigen::MatrixXd inner;
};

}  // namespace signorini
