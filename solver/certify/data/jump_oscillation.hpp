#pragma once

#include "fem/load_projection.hpp"
#include "fem/triangle_pieces.hpp"

namespace signorini {

/// A bound of (f − Πf, w) / ‖ε(w)‖ on one triangle where f jumps, for all w: less than half of what the norm
/// of f − Πf and a constant for all loads give, because it looks where f is what. On 4ⁿ pieces T_s that are
/// similar to the triangle T
///
///     f − Πf  =  r + Σ r_s + Σ q_s,
///
/// with r linear on each piece, r_s orthogonal on T_s to the linear functions, and q_s linear there, what the
/// integrals are off by. As f − Πf is orthogonal to linear p on T, but for what is carried
/// (carried_loads.hpp),
///
///     (f − Πf, w)  =  (r − Π₁r, w) + Σ (r_s, w − p_s) + Σ (q_s, w − p)
///                  ≤  (‖τ‖ + C/2ⁿ (Σ ‖r_s‖²)^{1/2} + C (Σ ‖q_s‖²)^{1/2}) ‖ε(w)‖,
///
/// C the constant of linear_remainder(), C/2ⁿ that of the pieces, and τ the least stress of LocalEquilibrium
/// with −div τ = r − Π₁r and no traction. From the reference triangle, x = x₀ + B x̂, one carries ŵ = Bᵀ w,
/// hence B⁻¹ r (for a membrane w and r as they are).
template <int D>
double jump_oscillation(const VectorField& load, const ProjectedLoad& projected,
                        const std::array<Point, 3>& corners, CellBudget& budget);

}  // namespace signorini
