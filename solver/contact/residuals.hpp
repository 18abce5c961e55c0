#pragma once

#include <algorithm>
#include <functional>

#include "fem/discretization.hpp"
#include "result/solution.hpp"

namespace signorini {

/// How far clearances λ and pressures p are from λ ≥ 0, p ≥ 0, λ p = 0. Relative, without unit.
struct ContactResiduals {
  double penetration = 0;      ///< max λ⁻ / max |λ|
  double tension = 0;          ///< max p⁻ / P
  double complementarity = 0;  ///< Σ w |λ p| / (Σ w |λ| · P)

  double largest() const { return std::max({penetration, tension, complementarity}); }
};

/// The one measure by which an iteration ends and its answer is judged. Pressures are compared with
/// P = max(max |p|, mean stress): with themselves, and where they are next to nothing, as of a body that
/// never touches, with the stress in the body, which their rounding belongs to. The weights are lengths.
ContactResiduals contact_residuals(const Eigen::VectorXd& clearance, const Eigen::VectorXd& pressure,
                                   const Eigen::VectorXd& weight, double mean_stress);

/// ‖σ_h‖ / √|Ω|, or what counts as no stress at all: a body that moves without strain has only rounding for
/// stress, and nothing to compare it with but what its displacement and clearance might have made.
/// `clearance` has an entry a row.
double mean_stress(const Discretization& discrete, const Eigen::MatrixXd& stress,
                   const Eigen::MatrixXd& displacement, const Eigen::VectorXd& clearance);

/// What the stress in the body says of the contact.
struct BodyState {
  double mean_stress;
  Eigen::VectorXd contact_forces;  ///< w p of the contact unknowns; empty if only S λ − c is known
};

/// The state of the body with these clearances.
using StateOfBody = std::function<BodyState(const Eigen::VectorXd& clearance)>;

/// Σ |next − last| / Σ |next|, the paper's criterion (section 6.1, iii); 0 if nothing changed.
double relative_change(const Eigen::Ref<const Eigen::MatrixXd>& last,
                       const Eigen::Ref<const Eigen::MatrixXd>& next);

/// The residuals of Problem 4.1 for stress, displacement and clearance, whatever method found them:
///
/// - equilibrium: the larger of ‖div σ_h + Πf‖ / (‖Πf‖ + ‖σ_h‖ / √|Ω|) and the largest jump of a normal
///   flux (on Γ_F its distance from t) over the largest flux;
/// - constitutive: the first equation, tested with the basis of RT_k, over the largest of its terms;
/// - symmetry: (as σ_h, φ_z) at the worst point z, over the sum of the sizes of its terms;
/// - the contact residuals, with mean_stress(). A node that Γ_C shares with Γ_D is left out: its
///   clearance is data, and no function of Λ_h tests its pressure.
///
/// `clearance` and `pressure` have one entry a row of the clearance space. Throws what Progress throws.
Residuals residuals(const Solution& solution, const Eigen::VectorXd& clearance,
                    const Eigen::VectorXd& pressure, const Discretization& discrete, Progress& progress);

}  // namespace signorini
