#pragma once

#include <array>
#include <vector>

#include "mesh/rings.hpp"

namespace signorini {

/// How many triangles the narrow places of a polygon make a mesh have, whatever its size.
///
/// Where the boundary has another edge across the domain at the distance d, triangles without sharp angles
/// have edges of about d, so that they are about as many as ∫ ds / d along the boundary. Where two edges meet
/// at a sharp angle that distance is their own, but for the tip, which one triangle fills.
struct NarrowPlaces {
  /// Parts of an edge, cut from it by halving, along which the domain is about as wide: neighbours that are
  /// about alike are one.
  struct Stretch {
    int edge;
    double length, width;  ///< of each part; infinitely wide if nothing is closer than the edge is long
    double least;          ///< the width at its narrower end
    int parts;
    bool is_mirrored;  ///< the edge across is the other side of a rectangle
  };

  double triangles = 0;
  int edge = 0;                    ///< the one with the most of them
  int opposite = 0;                ///< the one closest to it
  std::vector<Stretch> stretches;  ///< of all edges, one after the other
};

/// What a polygon without a fault has at most: triangles in its narrow places, which take some seconds to
/// make, and near edges, at which every check looks: so many take some tens of milliseconds.
inline constexpr double most_in_narrow_places = 300'000;
inline constexpr std::size_t most_near_pairs = 100'000;

/// Pairs of edges, by their numbers.
using EdgePairs = std::vector<std::array<int, 2>>;

/// Those closer to each other than they are long, or the first `most` of them. For any rings in the unit
/// frame.
EdgePairs near_edges(const Rings& unit, std::size_t most);

/// For rings in the unit frame that neither touch nor cross, and all their near edges. Stops counting at
/// `enough`.
NarrowPlaces narrow_places(const Rings& unit, const EdgePairs& near, double enough);

}  // namespace signorini
