#include "mesh/clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "mesh/meeting_boxes.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>>>;

struct Connection {
  std::array<int, 2> points;
  double distance;
};

/// Moves a point by another share of a billionth of its distance from the first for every number. Of many
/// points on one circle exact numbers would have to tell which lie within it, at twice the time, and the
/// distances are those of the points themselves.
Kernel::Point_2 moved(const Point& x, const Point& first, std::size_t number) {
  const auto by = [](double turns) { return 1 + 1e-9 * (turns - std::floor(turns)); };
  const double turns = std::numbers::phi * static_cast<double>(number);
  return {(x.x() - first.x()) * by(turns), (x.y() - first.y()) * by(2 * turns)};
}

/// Which ways lead into the domain.
class Inside {
 public:
  explicit Inside(const Rings& rings) : rings_(rings) {
    for (int ring = 0; ring < rings.size(); ++ring)
      on_the_left_.push_back(rings.has_domain_on_the_left(ring));
  }

  /// From a point of the rings straight to another.
  bool operator()(int from, int to) const {
    int first = rings_.next(from), last = rings_.before(from);
    if (!on_the_left_[rings_.ring[from]]) std::swap(first, last);
    const auto turn = [&](int one, int other) {
      return twice_area(rings_.points[from], rings_.points[one], rings_.points[other]);
    };
    return turn(first, last) > 0 ? turn(first, to) > 0 && turn(to, last) > 0
                                 : turn(last, to) < 0 || turn(to, first) < 0;
  }

 private:
  const Rings& rings_;
  std::vector<bool> on_the_left_;  ///< of the edges of each ring
};

/// The edges of the rings, and of Delaunay's triangulation those that lead through the domain, the shortest
/// first. Each set of points that is apart from the others is connected with the closest of them by one.
std::vector<Connection> connections(const Rings& rings) {
  const std::vector<Point>& points = rings.points;
  const Inside is_inside(rings);
  std::vector<std::pair<Kernel::Point_2, int>> numbered;
  for (std::size_t i = 0; i < points.size(); ++i)
    numbered.emplace_back(moved(points[i], points[0], i), static_cast<int>(i));
  // All at once, so that they go in in an order in which none is far from the last.
  Triangulation triangulation(numbered.begin(), numbered.end());
  std::vector<Connection> all;
  for (const auto& [face, side] : triangulation.finite_edges()) {
    const auto [from, to] = std::minmax(face->vertex(Triangulation::cw(side))->info(),
                                        face->vertex(Triangulation::ccw(side))->info());
    if (is_inside(from, to) && is_inside(to, from))
      all.push_back({{from, to}, (points[to] - points[from]).norm()});
  }
  for (int from = 0; from < static_cast<int>(points.size()); ++from) {
    const auto [a, b] = std::minmax({from, rings.next(from)});
    all.push_back({{a, b}, (points[b] - points[a]).norm()});
  }
  std::ranges::sort(all, {}, [](const Connection& each) { return std::pair(each.distance, each.points); });
  return all;
}

double extent(const Box& box) {
  return (box.high - box.low).maxCoeff();
}

}  // namespace

std::vector<Cluster> clusters(const Rings& rings) {
  const std::vector<Point>& points = rings.points;
  std::vector<int> leader(points.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int point) {
    while (leader[point] != point) point = leader[point] = leader[leader[point]];
    return point;
  };
  std::vector<Box> boxes;
  for (const Point& x : points) boxes.push_back({x, x});
  std::vector<Cluster> found;
  for (const auto& [ends, distance] : connections(rings)) {
    const int one = find(ends[0]), other = find(ends[1]);
    if (one == other) continue;
    for (const int each : {one, other})
      if (const double own = extent(boxes[each]); own > 0 && own < distance) found.push_back({own, distance});
    leader[other] = one;
    boxes[one] = box_around_both(boxes[one], boxes[other]);
  }
  return found;
}

}  // namespace signorini
