#pragma once

#include "certify/admissible_displacement.hpp"
#include "certify/contact_pressure.hpp"
#include "progress.hpp"

namespace signorini {

/// Goes on from the potential Ψ of a membrane's pressure, which is any with p* ≥ 0, to the one that makes the
/// bound least: it minimises
///
///     ‖C σ* − ε(v)‖²_E + ‖σ* − σ_h‖²_C + 2 <p*, g − v_n>,   σ* = σ_h + curl Ψ,   p* = p_h + ∂_t Ψ ≥ 0,
///
/// over the quadratic Ψ that vanish on Γ_F and beyond two layers of triangles around what is changed, with p*
/// kept on open edges. A primal active set: p* ≥ 0 holds after every step, so that each is an answer.
///
/// `clearance`: a value a row of the clearance space.
void minimize_potential(const Discretization& problem, const Solution& solution,
                        const AdmissibleDisplacement& v, const Eigen::VectorXd& clearance,
                        ContactPressure& pressure, Progress& progress);

}  // namespace signorini
