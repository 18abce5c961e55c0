#pragma once

#include "fem/traction_field.hpp"

namespace signorini {

// PEERS balances the mean of a load over a triangle and of a traction over an edge. A load that varies there
// has a couple besides, its moment about the centroid or the middle, that turns the body and that no constant
// displacement sees. The rotation takes it, so that the stress is in equilibrium of moments, too.

/// (x, y) turned by a right angle, counter-clockwise: the displacement of a rotation about the origin.
inline Vector turned_left(const Vector& x) {
  return {-x.y(), x.x()};
}

/// ∫ (x − x_e)^⊥ · t over an edge with the middle x_e, for a body with two components.
double couple_of_traction(const TractionField& traction, const Mesh& mesh, int edge);

}  // namespace signorini
