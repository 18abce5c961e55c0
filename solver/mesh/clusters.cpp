#include "mesh/clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "mesh/meeting_boxes.hpp"

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

/// Those of Delaunay's triangulation, the shortest first. Each set of points that is apart from the others is
/// connected with the closest of them by one.
std::vector<Connection> connections(const std::vector<Point>& points) {
  std::vector<std::pair<Kernel::Point_2, int>> numbered;
  for (std::size_t i = 0; i < points.size(); ++i)
    numbered.emplace_back(moved(points[i], points[0], i), static_cast<int>(i));
  // All at once, so that they go in in an order in which none is far from the last.
  Triangulation triangulation(numbered.begin(), numbered.end());
  std::vector<Connection> all;
  for (const auto& [face, side] : triangulation.finite_edges()) {
    const auto [from, to] = std::minmax(face->vertex(Triangulation::cw(side))->info(),
                                        face->vertex(Triangulation::ccw(side))->info());
    all.push_back({{from, to}, (points[to] - points[from]).norm()});
  }
  std::ranges::sort(all, {}, [](const Connection& each) { return std::pair(each.distance, each.points); });
  return all;
}

double extent(const Box& box) {
  return (box.high - box.low).maxCoeff();
}

}  // namespace

std::vector<Cluster> clusters(const std::vector<Point>& points) {
  std::vector<int> leader(points.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int point) {
    while (leader[point] != point) point = leader[point] = leader[leader[point]];
    return point;
  };
  std::vector<Box> boxes;
  for (const Point& x : points) boxes.push_back({x, x});
  std::vector<Cluster> found;
  for (const auto& [ends, distance] : connections(points)) {
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
