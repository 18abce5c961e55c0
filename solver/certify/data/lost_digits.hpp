#pragma once

#include <string>
#include <vector>

#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Why gaps, fixed values and laws are not what their formulas say: where large numbers cancel, the values in
/// doubles have too few digits (rounding_of()), in the middle of a triangle or an edge. Loads and tractions
/// carry what they lack: ProjectedLoad::uncertain_force. Throws what `progress` throws.
///
/// `displacement`: the largest; a gap or a fixed value that is off by much less does no harm.
std::vector<std::string> lost_digits(const Discretization& discrete, double displacement, Progress& progress);

}  // namespace signorini
