#pragma once

#include <string>
#include <vector>

#include "fem/discretization.hpp"

namespace signorini {

/// Why gaps, fixed values and laws are not what their formulas say: where large numbers cancel, the values in
/// doubles have too few digits (rounding_of()). Asked in the points where the scheme asks for the fields.
/// Loads and tractions carry what they lack: ProjectedLoad::uncertain_force.
///
/// `displacement`: the largest; a gap or a fixed value that is off by much less does no harm.
std::vector<std::string> lost_digits(const Discretization& problem, double displacement);

}  // namespace signorini
