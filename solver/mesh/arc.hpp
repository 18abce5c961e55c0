#pragma once

#include <string>

#include "mesh/mesh.hpp"

namespace signorini {

/// An arc of a circle from one point to another one, or a whole circle from a point to itself.
class CircularArc {
 public:
  /// The arc that the polygon's edge stands for. The centre is moved to the nearest place that is as far from
  /// one end as from the other: users round.
  CircularArc(const Point& from, const Point& to, const Point& centre, bool is_long);

  const Circle& circle() const { return circle_; }

  /// The point at a share t ∈ [0, 1] of the way along the arc.
  Point at(double t) const;

  /// In how many equal parts, two or more, it has to be cut for chords that are no longer than this and span
  /// at most an eighth of the straight angle.
  int parts(double longest_chord) const;

 private:
  Point from_;
  Circle circle_;
  double angle_;  ///< that it spans; negative if it runs clockwise
};

/// Why the centre fits no arc between the points, in words; empty if it does.
std::string why_no_arc(const Point& from, const Point& to, const Point& centre);

}  // namespace signorini
