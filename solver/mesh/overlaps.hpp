#pragma once

#include "mesh/edge_table.hpp"
#include "problem/field.hpp"

namespace signorini {

class Progress;

/// Hanging nodes, points that nearly coincide and overlapping triangles, for triangles that run
/// counter-clockwise and whose inner edges have one triangle on each side. The points are given as they
/// stand in messages, and in units in which the extent of the domain is about 1. Throws what a Progress
/// throws; without one it looks at so many pairs of edges at most, and leaves the rest to who has the time.
std::vector<Fault> faults_of_overlap(const EdgeTable& edges, const std::vector<Point>& given,
                                     const std::vector<Point>& scaled, Progress* progress);

}  // namespace signorini
