#pragma once

#include <vector>

#include "problem/field.hpp"

namespace signorini {

/// Points that lie closer to each other than to all others.
struct Cluster {
  double extent;    ///< the longer side of the box around it
  double distance;  ///< to the closest other point, larger than the extent
};

/// Of distinct points all clusters of more than one point.
///
/// Triangles without sharp angles grow from one to the next by no more than a factor: a mesh with the points
/// among its own has rings of triangles around a cluster, for every doubling of the distance from it about as
/// many, from its extent to its distance from the others or the size of the triangles there.
std::vector<Cluster> clusters(const std::vector<Point>& points);

}  // namespace signorini
