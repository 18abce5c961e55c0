#pragma once

#include <vector>

#include "contact/contact_complement.hpp"

namespace signorini {

/// Of the problem that a contact problem becomes along a change of its data: linear, with λ = 0 where contact
/// is closed and no force where it is open.
struct DualContact {
  Eigen::VectorXd clearance;
  std::vector<int> open;  ///< the unknowns without a force
  double largest_factor;  ///< the most that the force on one of the others is of that of the base
};

/// `c`: forces that would open the contact of the dual problem. Next to where contact begins its force grows
/// without bound beside that of the base: it is held at `factor` times that, though that opens it.
///
/// Throws SingularContact.
DualContact dual_contact(const ContactComplement& base, const Eigen::VectorXd& clearance,
                         const Eigen::VectorXd& c, double factor, Progress& progress);

}  // namespace signorini
