#pragma once

#include <array>
#include <span>
#include <vector>

namespace signorini {

/// An edge as one triangle has it: its points, ascending, and whether the triangle runs from the first to
/// the second.
struct TriangleEdge {
  std::array<int, 2> points;
  int triangle;
  bool forward;

  /// The points in the direction of the triangle.
  std::array<int, 2> directed() const { return forward ? points : std::array<int, 2>{points[1], points[0]}; }
};

/// The edges of triangles that need not form a mesh, sorted by their points.
class EdgeTable {
 public:
  explicit EdgeTable(const std::vector<std::array<int, 3>>& triangles);

  /// The entries of the edge between two points, one for each of its triangles.
  std::span<const TriangleEdge> between(std::array<int, 2> points) const;

  /// Calls visit with the entries of every edge.
  template <typename Visit>
  void for_each_edge(Visit visit) const {
    for (std::size_t i = 0; i < entries_.size();) {
      std::size_t end = i + 1;
      while (end < entries_.size() && entries_[end].points == entries_[i].points) ++end;
      visit(std::span(entries_).subspan(i, end - i));
      i = end;
    }
  }

 private:
  std::vector<TriangleEdge> entries_;
};

}  // namespace signorini
