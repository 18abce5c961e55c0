#pragma once

#include "certify/data/law_pieces.hpp"
#include "certify/data/motion_differences.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// What is not known of the load and of the traction acts with an unknown force on the triangles and on the
/// edges of Γ_F; what the pressure lacks, on edges of Γ_C. Some stress carries it from triangle to triangle,
/// along a spanning forest, to Γ_D, where any traction is free: with forces F and moments M of known size it
/// is at most
///
///     ‖τ‖_C  ≤  (Σ a_T²)^{1/2},    a_T = √c |J|² / √det J · ν |z|,
///
/// z the data of the element that makes the stress on T (tractions on edges, divergence), ν the norm of the
/// map from them to the stress on the reference triangle, J the Jacobian, c the largest eigenvalue of C; |J|
/// in place of |J|² for a membrane. It takes hardly any work and is some thousand times too large: enough for
/// what is known to many digits. For what is not, there is carried_by_motions().
///
/// Without Γ_D all of it is carried to one triangle, and there meets what p* and the rollers take: p* (1 +
/// r·d) in place of p*, and W r·n on rollers, W the mean of p*, with the rigid motion r for which G r has the
/// resultant,
///
///     G_ij = ∫_{Γ_C} p* (ρ_i·d) (ρ_j·d) + ∫_{rollers} W (ρ_i·n) (ρ_j·n).
///
/// That is admissible if |r·d| ≤ 1.
struct CarriedLoads {
  double norm = 0;
  /// Without Γ_D: the largest |r·d|, by which the contact term may grow.
  double change_of_pressure = 0;
  /// Neither Γ_D nor Γ_C and rollers take it: then the norm says nothing.
  bool is_held = true;
  /// Something is not known of the data, beside what the pressure lacks.
  bool are_of_data = false;
  /// What is carried, with what the pressure and the rollers take; and without Γ_D the triangle to which.
  UncertainLoads loads;
  std::optional<int> root = std::nullopt;
  double norm_on_patches = 0;  ///< of the stress that has brought loads back from there, which adds to `norm`
};

/// What is not known of the data on a patch of a membrane, whose triangles are parts of those of the whole:
/// some stress on each of the latter carries it from part to part until the same force acts as a constant
/// load on the triangle, which then stands for it in the whole.
struct LoadsBroughtBack {
  double square = 0;           ///< of the norm of that stress
  std::vector<double> forces;  ///< of each triangle of the whole, an entry each; empty: none
};

/// `parents`: of each triangle of the patch, the one of the whole that it is a part of; there are so many
/// `triangles`.
LoadsBroughtBack bring_back(const Discretization& patch, const LawOnMesh& laws,
                            const ContactPressure& pressure, const std::vector<int>& parents, int triangles);

/// With the loads that patches have brought back, if there are any.
CarriedLoads carry_uncertain_loads(const Discretization& discrete, const LawOnMesh& laws,
                                   const ContactPressure& pressure, const LoadsBroughtBack& of_patches = {});

}  // namespace signorini
