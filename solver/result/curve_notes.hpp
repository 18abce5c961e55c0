#pragma once

#include <string>
#include <vector>

#include "fem/discretization.hpp"

namespace signorini {

/// What a client should know of a body whose boundary is a curve, or stands for one: that the error bound is
/// of the chords, not of the arcs; and where an elastic body touches at corners that bend outwards without a
/// direction, that its pressure is infinite there.
///
/// Between two sides that touch without friction, at an angle ω, the displacement has a part r^(π/ω − 1): for
/// ω in (π/2, π) its stress is infinite in the corner. `clearance`: an entry a row.
std::vector<std::string> notes_on_curves(const Discretization& discrete, const Eigen::VectorXd& clearance);

}  // namespace signorini
