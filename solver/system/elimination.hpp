#pragma once

#include <Eigen/Cholesky>

#include "fem/element.hpp"

namespace signorini {

/// Stress and displacement of one triangle, and the forces G σ with which it acts on its coupling.
struct LocalFields {
  LocalVector stress;
  LocalVector displacement;
  LocalVector force;
};

/// Eliminates stress σ and displacement u of one triangle from its part of Problem 4.1 in hybrid form,
///
///     M σ + Bᵀ u = Gᵀ c,    B σ = −F,
///
/// for the coupling coefficients c = (m, γ): traces m in x and y components, and rotations γ. G = [E; −A],
/// where E selects the fluxes, which come first (their functionals are the moments against the trace basis,
/// so <τ_j n, m> = m_j), and A = (as τ, φ). With a basis Z of the stresses without divergence and B B⁺ = 1
/// (the null-space method: Benzi, Golub, Liesen 2005, section 6)
///
///     σ = P a + Qᵀ b,  u = Q a − W⁻¹ b    for   M σ + Bᵀ u = a,  B σ = b,
///     P = Z (Zᵀ M Z)⁻¹ Zᵀ,    Q = B⁺ᵀ (1 − M P),    W⁻¹ = B⁺ᵀ M Qᵀ,
///
/// where B P = 0 and B Qᵀ = 1 whatever M is, so that products do as well as substitutions. Hence
///
///     G σ = K c − G Qᵀ F,    K = G P Gᵀ.
class Elimination {
 public:
  Elimination(const ElementMatrices& element, const Spaces& spaces);

  LocalMatrix stiffness() const;      ///< K
  LocalMatrix coupling_load() const;  ///< G Qᵀ
  /// The fields for given coupling and load F.
  LocalFields recover(const LocalVector& coupling, const LocalVector& load,
                      const StrainMoments& strain) const;
  /// What the fields change by if the coupling does and div σ takes up what it lacks, −F − B σ.
  LocalFields respond(const LocalVector& coupling_change, const LocalVector& lack) const;
  LocalVector force(const LocalVector& stress) const { return coupling_.lazyProduct(stress); }  ///< G σ

 private:
  LocalFields solve(const LocalVector& a, const LocalVector& b) const;

  const Spaces& spaces_;
  LocalMatrix coupling_;  ///< G
  LocalMatrix root_;  ///< L⁻¹ Zᵀ with L Lᵀ = Zᵀ M Z: K is a square of it, and so never indefinite
  LocalMatrix p_, q_, w_inverse_;
};

/// The same with the displacement as data and the augmented compliance M_r = M + r Bᵀ V⁻¹ B (the form of
/// the paper's Uzawa iteration):
///
///     M_r σ = Gᵀ c − Bᵀ (u + r V⁻¹ F).
///
/// With w = u + r V⁻¹ F this gives G σ = K_r c − P w, and B σ = Pᵀ c − D w.
class AugmentedElimination {
 public:
  AugmentedElimination(const ElementMatrices& element, const Spaces& spaces, double augmentation);

  LocalMatrix stiffness() const;   ///< K_r = G M_r⁻¹ Gᵀ
  LocalMatrix coupling() const;    ///< P = G M_r⁻¹ Bᵀ
  LocalMatrix divergence() const;  ///< D = B M_r⁻¹ Bᵀ
  LocalVector stress(const LocalVector& coupling, const LocalVector& w) const;

 private:
  const LocalMatrix& b_;
  LocalMatrix coupling_;                ///< G
  Eigen::LLT<LocalMatrix> compliance_;  ///< M_r
  LocalMatrix lifted_;                  ///< M_r⁻¹ Bᵀ
};

}  // namespace signorini
