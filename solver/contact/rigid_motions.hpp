#pragma once

#include "fem/discretization.hpp"

namespace signorini {

/// Finds the rigid motions that no condition but contact prevents, and refuses what cannot come to rest: a
/// motion that slides along every contact, one that contact does not prevent and the load does not press
/// against, and a body that floats between its contacts. A mesh of several bodies is held only if each of
/// them is. Returns whether contact alone holds a body in some motion. Throws SolveError that names the
/// motion, and the body among several.
bool held_by_contact_alone(const Discretization& discrete);

}  // namespace signorini
