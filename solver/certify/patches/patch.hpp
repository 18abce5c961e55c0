#pragma once

#include <memory>
#include <vector>

#include "certify/pressure/contact_pressure.hpp"

namespace signorini {

/// The neighbourhood of a place on Γ_C, on a mesh of its own that is finer there. Its edges against the rest
/// of the whole mesh form the part Submesh::kCut.
struct Patch {
  std::shared_ptr<const Mesh> mesh;
  std::vector<int> parents;  ///< of each triangle, the one of the whole mesh that it is, or is part of
  std::vector<int> cut;      ///< the edges of the part kCut, by their numbers in the whole mesh
};

/// The patches around the contact edges on which p* is not p_h, but for those on which it hardly differs:
/// where contact ends. If a patch would be large, it is those on which it differs most. Of two layers of
/// triangles around them the inner one is cut three times, each time the triangles that lie at Γ_C.
std::vector<Patch> patches_where_pressure_changes(const Discretization& discrete,
                                                  const ContactPressure& pressure);

}  // namespace signorini
