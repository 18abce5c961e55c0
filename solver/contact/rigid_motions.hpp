#pragma once

#include <vector>

#include "fem/discretization.hpp"

namespace signorini {

/// A motion without strain: u = translation + rotation · (−(y − y₀), x − x₀) / size for an elastic body, with
/// (x₀, y₀) and size fixed by the mesh; for a membrane only the first component of the translation counts.
using RigidMotion = Eigen::Vector3d;

/// Finds the rigid motions that no condition but contact prevents, and refuses what cannot come to rest: a
/// motion that slides along every contact, and a load that does not press the body on its contact. A mesh of
/// several bodies is held only if each of them is. Returns whether contact alone holds a body in some motion.
/// Throws SolveError that names the motion, and the body among several.
bool held_by_contact_alone(const Discretization& problem);

}  // namespace signorini
