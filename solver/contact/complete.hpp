#pragma once

#include <vector>

#include "contact/condense.hpp"
#include "system/recovery.hpp"

namespace signorini {

/// All coupling unknowns for the clearances of a contact problem, with stress and displacement.
struct Completed {
  Eigen::VectorXd coupling;
  Recovered fields;
};

/// `exactly_open`: the contact unknowns whose pressure is to vanish to rounding.
Completed complete(const Discretization& discrete, CondensedContact& condensed,
                   const Eigen::VectorXd& clearance, const std::vector<int>& exactly_open,
                   Progress& progress);

/// The contact unknowns with a clearance.
std::vector<int> open_unknowns(const Eigen::VectorXd& clearance);

}  // namespace signorini
