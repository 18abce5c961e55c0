#pragma once

#include <array>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

class Progress;

using Segment = std::array<Point, 2>;

/// Twice the signed area of the triangle a, b, c: positive if it runs counter-clockwise.
double twice_area(const Point& a, const Point& b, const Point& c);

Point nearest_point(const Point& x, const Segment& segment);

/// The distance of a point from the nearest point of a segment.
double distance(const Point& x, const Segment& segment);

/// The distance of a point from the nearest point of a triangle; 0 inside.
double distance(const Point& x, const std::array<Point, 3>& triangle);

/// Whether the segments cross in the interior of both. Sure only for segments none of whose ends is close
/// to the other segment.
bool cross(const Segment& a, const Segment& b);

/// How often closed curves, given by their directed segments, wind counter-clockwise around a point that
/// lies on none of them.
int winding_number(const Point& x, const std::vector<Segment>& curves);

/// The same for many points. Throws what a Progress throws, if there is one.
std::vector<int> winding_numbers(const std::vector<Point>& points, const std::vector<Segment>& curves,
                                 Progress* progress);

}  // namespace signorini
