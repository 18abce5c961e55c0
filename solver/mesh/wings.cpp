#include "mesh/wings.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace signorini {
namespace {

/// Which of the wings around a point its neighbours belong to.
class Wings {
 public:
  Wings(const std::vector<std::array<int, 3>>& triangles, const std::vector<int>& star, int point) {
    for (const int t : star) {
      int first = -1;
      for (const int neighbour : triangles[t]) {
        if (neighbour == point) continue;
        const int own = root(wing_.try_emplace(neighbour, neighbour).first->first);
        if (first < 0)
          first = own;
        else
          wing_[own] = root(first);
      }
    }
  }

  /// The number of one of the neighbours in the same wing.
  int of(int neighbour) { return root(neighbour); }

 private:
  /// Halves the way each time that it is gone.
  int root(int neighbour) {
    while (wing_[neighbour] != neighbour) neighbour = wing_[neighbour] = wing_[wing_[neighbour]];
    return neighbour;
  }

  std::unordered_map<int, int> wing_;
};

}  // namespace

std::string separate_wings(std::vector<Point>& points, std::vector<std::array<int, 3>>& triangles,
                           std::vector<std::vector<std::array<int, 2>>>& parts) {
  // The boundary runs through a point once for each of its wings.
  std::vector<int> passages(points.size(), 0);
  for (const auto& part : parts)
    for (const auto& edge : part) ++passages[edge[0]];
  struct Around {
    std::vector<int> triangles;
    std::vector<std::array<int, 2>*> edges;
  };
  std::map<int, Around> shared;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (const int point : triangles[t])
      if (passages[point] > 1) shared[point].triangles.push_back(t);
  for (auto& part : parts)
    for (auto& edge : part)
      for (const int point : edge)
        if (passages[point] > 1) shared[point].edges.push_back(&edge);

  for (const auto& [point, around] : shared) {
    Wings wings(triangles, around.triangles, point);
    std::unordered_map<int, int> points_of_wings;
    const auto own_point = [&, point = point](int neighbour) {
      const bool is_first = points_of_wings.empty();
      const auto [own, is_new] = points_of_wings.try_emplace(
          wings.of(neighbour), is_first ? point : static_cast<int>(points.size()));
      if (is_new && !is_first) points.push_back(Point(points[point]));
      return own->second;
    };
    for (const int t : around.triangles) {
      const auto place = std::ranges::find(triangles[t], point);
      *place = own_point(triangles[t][(place - triangles[t].begin() + 1) % 3]);
    }
    for (std::array<int, 2>* edge : around.edges) {
      const int end = (*edge)[0] == point ? 0 : 1;
      (*edge)[end] = own_point((*edge)[1 - end]);
    }
  }
  if (shared.empty()) return {};
  const std::size_t others = shared.size() - 1;
  return "parts of the domain meet at " + to_string(points[shared.begin()->first]) +
         (others > 0 ? " and " + std::to_string(others) + " more points" : "") +
         " without an edge in common: a point does not hold them together, and each has one of its own there";
}

}  // namespace signorini
