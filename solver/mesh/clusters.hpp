#pragma once

#include <vector>

#include "mesh/rings.hpp"

namespace signorini {

/// Points that lie closer to each other than to all others that are seen from them.
struct Cluster {
  double extent;    ///< the longer side of the box around it
  double distance;  ///< to the closest other point, larger than the extent
};

/// Of the points of rings all clusters of more than one point: by the ways between them through the domain.
///
/// Triangles without sharp angles grow from one to the next by no more than a factor: a mesh with the points
/// among its own has rings of triangles around a cluster, for every doubling of the distance from it about as
/// many, from its extent to its distance from the others or the size of the triangles there.
std::vector<Cluster> clusters(const Rings& rings);

}  // namespace signorini
