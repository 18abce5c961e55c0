#pragma once

#include <algorithm>
#include <vector>

#include "mesh/mesh.hpp"
#include "problem/quantity.hpp"

namespace signorini {

/// A straight piece between two points.
struct Piece {
  Point a, b;

  double distance_to(const Point& x) const {
    const double s = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0., 1.);
    return (a + s * (b - a) - x).norm();
  }

  /// In no end of either.
  bool crosses(const Piece& other) const {
    const auto side = [](const Piece& of, const Point& x) {
      const Vector way = of.b - of.a, off = x - of.a;
      return way.x() * off.y() - way.y() * off.x();
    };
    const auto differ = [](double one, double two) { return (one < 0 && two > 0) || (one > 0 && two < 0); };
    return differ(side(*this, other.a), side(*this, other.b)) && differ(side(other, a), side(other, b));
  }

  /// The ray to the right of x meets it.
  bool is_right_of(const Point& x) const {
    return (a.y() > x.y()) != (b.y() > x.y()) &&
           x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
  }
};

/// The rectangle around points, with sides along the axes.
struct Extent {
  Point low, high;

  explicit Extent(const Piece& piece) : low(piece.a.cwiseMin(piece.b)), high(piece.a.cwiseMax(piece.b)) {}
  explicit Extent(const std::vector<Piece>& pieces) : Extent(pieces.front()) {
    for (const Piece& piece : pieces) low = low.cwiseMin(piece.a), high = high.cwiseMax(piece.a);
  }

  bool meets(const Extent& other) const {
    return low.x() <= other.high.x() && other.low.x() <= high.x() && low.y() <= other.high.y() &&
           other.low.y() <= high.y();
  }
};

/// By a ray to the right (Sutherland and others 1974).
inline bool is_within(const std::vector<Piece>& ring, const Point& x) {
  return std::ranges::count_if(ring, [&](const Piece& piece) { return piece.is_right_of(x); }) % 2 == 1;
}

inline std::vector<Piece> sides_of(const std::vector<Point>& corners) {
  std::vector<Piece> sides;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sides.push_back({corners[i], corners[(i + 1) % corners.size()]});
  return sides;
}

/// No two of its sides cross.
inline bool is_simple(const Outline& outline) {
  const std::vector<Piece> sides = sides_of(outline.corners);
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size(); ++j)
      if (sides[i].crosses(sides[j])) return false;
  return true;
}

/// What lies in the body, as its boundary tells, which has fewer edges than the body has triangles.
class Region {
 public:
  explicit Region(const Mesh& mesh) : diameter_(mesh.diameter()) {
    for (const BoundaryPart& part : mesh.boundary)
      for (const int edge : part.edges) {
        const Piece own{mesh.points[mesh.edges[edge][0]], mesh.points[mesh.edges[edge][1]]};
        boundary_.push_back(own);
        outside_.push_back((own.a + own.b) / 2 +
                           (own.a - own.b).norm() * kLeastDisc * mesh.outward_normal(edge));
      }
  }

  bool contains(const Disc& disc) const {
    return contains(disc.centre) && std::ranges::all_of(boundary_, [&](const Piece& edge) {
             return edge.distance_to(disc.centre) >= disc.radius;
           });
  }

  bool can_be_seen(const Disc& disc) const {
    return disc.radius >= kLeastDisc * std::max(diameter_, disc.centre.norm());
  }

  /// Its corners lie in the body, no side crosses the boundary, and no hole lies within.
  bool contains(const Outline& outline) const {
    const std::vector<Piece> sides = sides_of(outline.corners);
    const Extent around(sides);
    for (std::size_t i = 0; i < boundary_.size(); ++i) {
      const Extent own(boundary_[i]);
      if (!own.meets(around)) continue;
      const auto is_crossed_by = [&](const Piece& side) {
        return own.meets(Extent(side)) && side.crosses(boundary_[i]);
      };
      // Of an edge that lies on a side rounding tells nothing, and of the next one across neither.
      if (std::ranges::any_of(sides, is_crossed_by) || is_within(sides, outside_[i])) return false;
    }
    return std::ranges::all_of(outline.corners, [&](const Point& x) { return contains(x); });
  }

 private:
  /// Beside the body and its coordinates. In a smaller disc the sign of a difference of squares is not known,
  /// for rounding is taken to be 1e-14 of them (formula/interval.hpp).
  static constexpr double kLeastDisc = 1e-6;

  /// Or on its boundary, but for rounding.
  bool contains(const Point& x) const {
    constexpr double rounding = 1e-12;
    return is_within(boundary_, x) || std::ranges::any_of(boundary_, [&](const Piece& edge) {
             return edge.distance_to(x) <= rounding * diameter_;
           });
  }

  std::vector<Piece> boundary_;
  std::vector<Point> outside_;  ///< of each of them, a point beside its middle, not in the body
  const double diameter_;
};

}  // namespace signorini
