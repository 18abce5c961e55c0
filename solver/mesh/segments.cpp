#include "mesh/segments.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "progress/progress.hpp"

namespace signorini {

double twice_area(const Point& a, const Point& b, const Point& c) {
  const Vector ab = b - a, ac = c - a;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

Point nearest_point(const Point& x, const Segment& segment) {
  const Vector along = segment[1] - segment[0];
  const double length_squared = along.squaredNorm();
  if (length_squared == 0) return segment[0];
  const double at = std::clamp((x - segment[0]).dot(along) / length_squared, 0.0, 1.0);
  return segment[0] + at * along;
}

double distance(const Point& x, const Segment& segment) {
  return (x - nearest_point(x, segment)).norm();
}

double distance(const Point& x, const std::array<Point, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const double at_a = twice_area(x, b, c), at_b = twice_area(x, c, a), at_c = twice_area(x, a, b);
  if ((at_a >= 0 && at_b >= 0 && at_c >= 0) || (at_a <= 0 && at_b <= 0 && at_c <= 0)) return 0;
  return std::min({distance(x, Segment{a, b}), distance(x, Segment{b, c}), distance(x, Segment{c, a})});
}

bool cross(const Segment& a, const Segment& b) {
  const auto on_both_sides = [](const Segment& ends, const Segment& line) {
    return (twice_area(line[0], line[1], ends[0]) > 0) != (twice_area(line[0], line[1], ends[1]) > 0);
  };
  return on_both_sides(a, b) && on_both_sides(b, a);
}

int winding_number(const Point& x, const std::vector<Segment>& curves) {
  int turns = 0;
  // Counts the crossings with the ray from x to the right; an end at the height of x counts as above it.
  // Without a branch, for of many bodies in a row all edges are looked at for each point.
  for (const auto& [from, to] : curves) {
    const bool begins_below = from.y() < x.y(), ends_below = to.y() < x.y();
    const double side = twice_area(from, to, x);
    turns += static_cast<int>(begins_below & !ends_below & (side > 0)) -
             static_cast<int>(ends_below & !begins_below & (side < 0));
  }
  return turns;
}

std::vector<int> winding_numbers(const std::vector<Point>& points, const std::vector<Segment>& curves,
                                 Progress* progress) {
  std::vector<int> by_height(points.size());
  std::iota(by_height.begin(), by_height.end(), 0);
  std::ranges::sort(by_height, {}, [&](int i) { return points[i].y(); });
  const auto low = [](const Segment& edge) { return std::min(edge[0].y(), edge[1].y()); };
  const auto high = [](const Segment& edge) { return std::max(edge[0].y(), edge[1].y()); };
  std::vector<Segment> rising = curves;
  std::ranges::sort(rising, {}, low);
  // The ray of a point meets only edges at its height.
  std::vector<Segment> at_height;
  double lowest_end = std::numeric_limits<double>::infinity();
  std::vector<int> turns(points.size());
  auto next = rising.begin();
  for (const int i : by_height) {
    if (progress) progress->check();
    const Point& x = points[i];
    for (; next != rising.end() && low(*next) < x.y(); ++next) {
      at_height.push_back(*next);
      lowest_end = std::min(lowest_end, high(*next));
    }
    if (lowest_end < x.y()) {
      std::erase_if(at_height, [&](const Segment& edge) { return high(edge) < x.y(); });
      lowest_end = std::numeric_limits<double>::infinity();
      for (const Segment& edge : at_height) lowest_end = std::min(lowest_end, high(edge));
    }
    turns[i] = winding_number(x, at_height);
  }
  return turns;
}

}  // namespace signorini
