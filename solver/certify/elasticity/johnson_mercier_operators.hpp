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
  /// piece needs for squares of fields of a degree, with the errors of the pieces.
  void fill(const Spaces& spaces, const std::vector<LawPiece>& pieces, int of_fields, double tolerance);

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

/// Integrals over the reference triangle of the functions at the inner nodes, times those of P2 on the triangle
/// and times each other.
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
/// coefficients of σ_h.
template <int Columns>
struct JohnsonMercierStress {
  template <int Rows>
  using Block = Eigen::Matrix<double, Rows, Columns>;

  /// The law at every point of the rule, or one for all.
  JohnsonMercierStress(const JohnsonMercierRule& rule, const AffineMap& map,
                       const Block<JohnsonMercier::kData>& data, const Block<Eigen::Dynamic>& coefficients,
                       std::span<const SymmetricLaw> laws);

  /// By points, tensors of Mandel: the stress with the data that is nearest to σ_h, and the symmetric part of
  /// σ_h itself.
  std::vector<Block<3>> admissible, discrete;
  Block<Eigen::Dynamic> skew;  ///< of σ_h: a row a point
};

/// √weight (σ* − the symmetric part of σ_h) in the norm of C, the rows of all points.
template <int Columns>
Eigen::Matrix<double, Eigen::Dynamic, Columns> correction(const JohnsonMercierRule& rule,
                                                          const AffineMap& map,
                                                          const JohnsonMercierStress<Columns>& stress,
                                                          std::span<const SymmetricLaw> laws);

/// What the bound integrates over a triangle, for any number of columns of what describes it: the data of the
/// macro-element, the coefficients of σ_h, and v_h at the nodes of P2 (x and y in turns). All is linear in
/// them, so that the columns of the unit matrix give the operators of a shape, and a single column the values
/// of one triangle. Rows: of every point, √weight times a tensor such that the square of the norm of a column
/// is the integral.
template <int Columns>
struct JohnsonMercierOperators {
  template <int Rows>
  using Block = Eigen::Matrix<double, Rows, Columns>;

  struct Given {
    Block<JohnsonMercier::kData> data;
    Block<Eigen::Dynamic> stress;
    Block<12> displacement;
    /// Strains (Mandel) at the points that come to those of v_h; none if empty.
    std::vector<Eigen::Vector3d> lifted;
  };

  /// The law at every point of the rule, or one for all.
  JohnsonMercierOperators(const JohnsonMercierRule& rule, const AffineMap& map, const Given& given,
                          std::span<const SymmetricLaw> laws);

  Block<Eigen::Dynamic> gap;         ///< C σ* − ε(v), in the norm of E
  Block<Eigen::Dynamic> direct_gap;  ///< C sym σ_h − ε(v), in the norm of E
  Block<Eigen::Dynamic> correction;  ///< σ* − the symmetric part of σ_h, in the norm of C
  Block<Eigen::Dynamic> skew;        ///< the skew part of σ_h, in the norm of C
  Block<Eigen::Dynamic> stress;      ///< σ_h, in the norm of C
  Block<Eigen::Dynamic> strain;      ///< ε(v), in the norm of E
  /// The values of v at the inner nodes beyond those of v_h.
  Block<2 * JohnsonMercierRule::kInner> inner;
};

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
