#pragma once

#include "certify/quantities/certified_solution.hpp"
#include "problem/settings.hpp"

namespace signorini {

/// The body of a problem without its loads and contacts, held where it is held, which the weights pull.
Problem pulled_body(const Quantity& quantity, Problem problem);

/// That of the part that a contact edge lies on; null if there is none.
const Field* weight_on(const std::map<std::string, Field>& weights, const Discretization& discrete,
                       const ContactEdge& contact);

/// ∫ w λ of the discrete solution.
double opening_of(const Quantity& quantity, const Discretization& discrete, const Eigen::VectorXd& clearance);

/// A bound of the norm of the stress τ with τ n = w d on the contacts, 0 on Γ_F and div τ = 0: twice the
/// energy that the pull takes. The body is solved without its contacts, pulled by w where they were, and
/// without its loads.
struct Pull {
  double norm;                     ///< infinite if nothing is known of it
  std::vector<std::string> unmet;  ///< why it is not guaranteed
};
Pull pull_of(const Quantity& quantity, const Discretization& discrete, Factorization by, Progress& progress);

/// Encloses ∫ w λ, between its ends: ∫ w (g − v_n) and what that may be off by, THEORY.md, Theorem 6.
///
/// `radius`: of QuantityEnclosure. Adds to `unmet` why nothing is guaranteed; infinite if nothing is known.
std::array<double, 2> enclose_opening(const Quantity& quantity, const CertifiedSolution& base, double radius,
                                      const Pull& pull, Progress& progress, std::vector<std::string>& unmet);

}  // namespace signorini
