#pragma once

#include <array>
#include <optional>

#include "mesh/rings.hpp"

namespace signorini {

/// How many triangles the narrow places of a polygon make a mesh have, whatever its size.
///
/// Where the boundary has another edge across the domain at the distance d, triangles without sharp angles
/// have edges of about d, so that they are about as many as ∫ ds / d along the boundary. Where two edges meet
/// at a sharp angle that distance is their own, but for the tip, which one triangle fills.
struct NarrowPlaces {
  double triangles = 0;
  int edge = 0;      ///< the one with the most of them
  int opposite = 0;  ///< the one closest to it
};

/// A pair of edges closer to each other than they are long if there are more such pairs than `most`; nothing
/// if not. For any rings in the unit frame.
std::optional<std::array<int, 2>> pair_of_near_edges(const Rings& unit, std::size_t most);

/// For rings in the unit frame that neither touch nor cross. Stops counting at `enough`.
NarrowPlaces narrow_places(const Rings& unit, double enough);

}  // namespace signorini
