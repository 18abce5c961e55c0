#pragma once

#include "certify/quantities/certified_solution.hpp"
#include "problem/settings.hpp"

namespace signorini {

/// ∫ w λ of the discrete solution.
double opening_of(const Quantity& quantity, const Discretization& discrete, const Eigen::VectorXd& clearance);

/// Encloses ∫ w λ, between its ends: ∫ w (g − v_n) and what that may be off by, THEORY.md, Theorem 6. The
/// body is solved anew without its contacts, pulled by w where they were.
///
/// `radius`: of QuantityEnclosure. Adds to `unmet` why nothing is guaranteed; infinite if nothing is known.
std::array<double, 2> enclose_opening(const Quantity& quantity, const CertifiedSolution& base, double radius,
                                      const Settings& settings, Progress& progress,
                                      std::vector<std::string>& unmet);

}  // namespace signorini
