#pragma once

#include "certify/admissible_pair.hpp"
#include "certify/patches/local_contact.hpp"

namespace signorini {

/// Two better pairs of a membrane on a patch, admissible together with the pair of the whole outside.
///
/// The first is close to σ and u: v of the contact problem on the patch with v given on the cut, σ* of that
/// with σ* n given there. The second differs from it by about as much as σ* from σ_h: with δ = σ* − σ_h,
///
///     E ε(v − v₂) + (σ* − σ*₂) ≈ δ.
///
/// Any field is such a sum (Helmholtz): where contact is closed, v₂ = v and the pressure takes what δ has for
/// a normal trace; where it is open, the other way round.
class PatchPairs {
 public:
  /// `pair`: of the whole. Throws like LocalContact.
  PatchPairs(const Discretization& whole, const Eigen::MatrixXd& stress, const AdmissiblePair& pair,
             Patch patch, Progress& progress);

  /// Both pairs are admissible.
  bool are_admissible() const;

  const Patch& patch() const { return patch_; }
  /// With v given on the cut.
  const Discretization& discretization() const { return held_.discretization(); }
  const AdmissiblePair& first() const { return first_; }
  const AdmissiblePair& second() const { return second_; }
  /// A column of coefficients a triangle of the patch: of σ_h, and of σ* − σ_h without the stream function.
  const Eigen::MatrixXd& stress() const { return stress_; }
  const Eigen::MatrixXd& change() const { return change_; }

 private:
  AdmissiblePair first_pair(Progress& progress) const;
  AdmissiblePair second_pair(Progress& progress) const;

  Patch patch_;
  LocalContact held_, loaded_;
  Eigen::MatrixXd stress_, change_;
  AdmissiblePair first_, second_;
};

}  // namespace signorini
