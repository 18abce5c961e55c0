#pragma once

#include <string>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

/// Coordinates in which the longer side of a domain's bounding box is 1 and its lower left corner 0, rounded
/// to multiples of 2⁻⁴⁰: the same domain in other units of length has the same coordinates there but for
/// ties in the rounding, so that geometry decided there does not depend on the units.
class UnitFrame {
 public:
  /// The frame of the bounding box of the points, which must be finite and not all the same.
  explicit UnitFrame(const std::vector<Point>& points);

  double extent() const { return extent_; }
  Point into(const Point& x) const;
  /// The same without rounding to the grid.
  Point scaled(const Point& x) const { return (x - low_) / extent_; }
  /// A length, rounded likewise to 40 binary digits.
  double into(double length) const;
  Point out_of(const Point& x) const { return low_ + extent_ * x; }

 private:
  Point low_;
  double extent_;
};

/// Why no frame fits the points, in words; empty if one does: they are not finite or all the same, lie so
/// far from the origin that neighbours could not be told apart, or their areas are no ordinary numbers.
std::string why_no_frame(const std::vector<Point>& points);

}  // namespace signorini
