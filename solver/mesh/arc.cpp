#include "mesh/arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace signorini {
namespace {

using std::numbers::pi;

/// By how much of the distance between the ends the radii to both may differ, and by how much of the radius
/// the centre of a half circle may miss the middle.
constexpr double kInaccuracy = 1e-6;

/// A radius of so many distances between the ends makes a straight line, but for rounding.
constexpr double kStraight = 1e6;

double spanned_angle(const Point& from, const Point& to, const Point& centre, bool is_long) {
  if (from == to) return 2 * pi;
  const Vector chord = to - from, to_centre = centre - (from + to) / 2;
  // The centre's distance from the chord, positive on its left.
  const double apothem = Vector(-chord.y(), chord.x()).dot(to_centre) / chord.norm();
  const bool is_half = std::abs(apothem) <= kInaccuracy * chord.norm();
  // Seen from the left the shorter arc runs counter-clockwise.
  const bool counter_clockwise = is_long != (is_half || apothem > 0);
  return counter_clockwise ? 2 * std::atan2(chord.norm() / 2, apothem)
                           : -2 * std::atan2(chord.norm() / 2, -apothem);
}

Point equidistant(const Point& from, const Point& to, const Point& centre) {
  if (from == to) return centre;
  const Vector along = (to - from).normalized();
  return centre - along.dot(centre - (from + to) / 2) * along;
}

}  // namespace

CircularArc::CircularArc(const Point& from, const Point& to, const Point& centre, bool is_long)
    : from_(from), angle_(spanned_angle(from, to, centre, is_long)) {
  circle_.centre = equidistant(from, to, centre);
  circle_.radius = (from - circle_.centre).norm();
}

Point CircularArc::at(double t) const {
  return circle_.centre + Eigen::Rotation2Dd(t * angle_) * (from_ - circle_.centre);
}

int CircularArc::parts(double longest_chord) const {
  constexpr double most = pi / 8;
  constexpr double rounding = 1e-9;
  const double chord = 2 * std::asin(std::min(1., longest_chord / (2 * circle_.radius)));
  return std::max(2, static_cast<int>(std::ceil(std::abs(angle_) / std::min(most, chord) - rounding)));
}

std::string why_no_arc(const Point& from, const Point& to, const Point& centre) {
  if (!centre.allFinite()) return "must be finite";
  const double one = (from - centre).norm(), other = (to - centre).norm(), chord = (to - from).norm();
  if (centre == from || centre == to) return "is an end of the arc: the radius is zero";
  // What the angle is made of is at most four times as much.
  if (!std::isnormal(16 * one * one) || !std::isnormal(16 * other * other))
    return "makes the radius too large or too small for its square to be a number: use other units";
  if (from == to) return {};
  if (std::max(one, other) > kStraight * chord)
    return "lies so far away that the arc is straight but for rounding: leave the arc out";
  if (std::abs(one - other) > kInaccuracy * chord)
    return "must be as far from " + to_string(from) + ", where the arc begins, as from " + to_string(to) +
           ", where it ends; the nearest point that is so is " + to_string(equidistant(from, to, centre));
  return {};
}

}  // namespace signorini
