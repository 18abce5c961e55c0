#pragma once

#include "contact/active_set.hpp"
#include "contact/residuals.hpp"

namespace signorini {

/// The Uzawa iteration λ ← max(0, λ + ρ σ_n(λ)) with the displacement eliminated exactly: a projected
/// gradient in which σ_n is affine with the matrix S. The step is ρ_i = w_i / (L S_ii), with L a bound of the
/// largest eigenvalue of S scaled by its diagonal (Lanczos). Between such steps, which find out what is open,
/// conjugate gradients with a multilevel scaling work on the open part (MPRGP: Dostál, Schöberl 2005; Dostál,
/// *Optimal quadratic programming algorithms*, 2009, chapter 5): the count hardly grows with 1/h. Converges
/// for every positive definite S, and for a semidefinite one if the problem has a solution, at every scale of
/// units, from every start ≥ 0; without one, from 0. Throws SolveError if nothing holds the body.
///
/// It ends when the contact residuals are below the tolerance, or rounding. They are those of the answer: S
/// does not know the stress in the body, so that a small part of the pressures at λ = 0 stands for it until
/// they are met; and where the body is nearly incompressible, S λ − c has lost digits of the pressures that
/// the stress has. So `body` is asked then, its answer put in the place of both, and the iteration goes on
/// until the residuals are met by that. It is asked last for the clearance of a result that converged.
ContactResult mprgp(const ContactComplement& contact, const Mprgp& settings, Progress& progress,
                    const StateOfBody& body, const Eigen::VectorXd& start = {});

}  // namespace signorini
