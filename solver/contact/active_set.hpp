#pragma once

#include "contact/contact_complement.hpp"
#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The clearances that a method on the contact complement found.
struct ContactResult {
  Eigen::VectorXd clearance;
  Outcome outcome = Outcome::converged;
};

/// Primal-dual active set: guess which clearances are closed, solve for the others, exchange every one
/// that violates λ ≥ 0 or p ≥ 0. If the number of violations has not fallen for some steps, exchange only
/// the one of least index until it falls, which ends for every symmetric positive definite S (Murty 1974;
/// Júdice, Pires 1994, block principal pivoting). Exact to rounding.
///
/// The first guess is the closed part of the start, clearances ≥ 0; without one, everything.
ContactResult active_set(const ContactComplement& contact, const ActiveSet& settings, Progress& progress,
                         const Eigen::VectorXd& start = {});

}  // namespace signorini
