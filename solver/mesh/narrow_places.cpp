#include "mesh/narrow_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/meeting_boxes.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// Measured: triangles that a mesh has for each edge that the boundary gets in a narrow place, on both sides
/// of it.
constexpr double triangles_per_edge = 2.5;

/// Pairs of edges closer than they are long; more of them are an intricate domain indeed.
constexpr std::size_t most_pairs = 5'000'000;

Segment segment_of(const Rings& rings, int edge) {
  return {rings.points[edge], rings.points[rings.next(edge)]};
}

double length_of(const Segment& segment) {
  return (segment[1] - segment[0]).norm();
}

/// Calls visit(i, j) for every pair of edges closer to each other than they are long, until it returns false.
template <typename Visit>
void for_each_near_pair(const Rings& unit, const Visit& visit) {
  std::vector<Box> boxes;
  for (int edge = 0; edge < static_cast<int>(unit.points.size()); ++edge) {
    const Segment ends = segment_of(unit, edge);
    boxes.push_back(box_around(ends, length_of(ends) / 2));
  }
  for_each_meeting_pair(boxes, visit);
}

class Count {
 public:
  Count(const Rings& unit, double enough) : rings_(unit), enough_(enough), near_(unit.points.size()) {
    for (int ring = 0; ring < unit.size(); ++ring)
      domain_on_the_left_.push_back((unit.signed_area(ring) > 0) == (ring == 0));
  }

  NarrowPlaces run() {
    if (!find_pairs()) return {std::numeric_limits<double>::infinity(), last_pair_[0], last_pair_[1]};
    double most = 0;
    for (int edge = 0; edge < static_cast<int>(near_.size()) && found_.triangles < enough_; ++edge) {
      const double before = found_.triangles;
      closest_ = std::numeric_limits<double>::infinity();
      add({edge, 0, 1}, near_[edge]);
      if (found_.triangles - before <= most) continue;
      most = found_.triangles - before;
      found_.edge = edge;
      found_.opposite = opposite_;
    }
    return found_;
  }

 private:
  /// The part of an edge between two shares of its way.
  struct Piece {
    int edge;
    double begin, end;
  };

  Segment segment(int edge) const { return segment_of(rings_, edge); }
  double length(int edge) const { return length_of(segment(edge)); }

  /// The other edges closer to an edge than it is long.
  bool find_pairs() {
    std::size_t pairs = 0;
    for_each_near_pair(rings_, [&](int i, int j) {
      near_[i].push_back(j);
      near_[j].push_back(i);
      last_pair_ = {i, j};
      return ++pairs < most_pairs;
    });
    return pairs < most_pairs;
  }

  /// The distance of a point on an edge from another edge that it sees across the domain.
  double across(const Point& x, int edge, int other) const {
    const double none = std::numeric_limits<double>::infinity();
    const Segment own = segment(edge), ends = segment(other);
    const bool before = rings_.next(other) == edge, behind = rings_.next(edge) == other;
    if (before || behind) {
      const double to_tip = (x - (before ? own[0] : own[1])).norm();
      if (to_tip < 0.5 * std::min(length(edge), length(other))) return none;
    }
    const Point y = nearest_point(x, ends);
    const Vector way = own[1] - own[0], to_other = y - x;
    const double left = way.x() * to_other.y() - way.y() * to_other.x();
    const bool inside = domain_on_the_left_[rings_.ring[edge]] ? left > 0 : left < 0;
    return inside ? to_other.norm() : none;
  }

  void add(const Piece& piece, const std::vector<int>& candidates) {
    const Segment ends = segment(piece.edge);
    const double whole = length(piece.edge), own = whole * (piece.end - piece.begin);
    const Point middle = ends[0] + 0.5 * (piece.begin + piece.end) * (ends[1] - ends[0]);
    double width = whole;
    for (const int other : candidates) {
      const double distance = across(middle, piece.edge, other);
      if (distance < closest_) closest_ = distance, opposite_ = other;
      width = std::min(width, distance);
    }
    constexpr double steps = 4;  // of a piece, that its middle speaks for
    if (own <= steps * width) {
      if (width < whole) found_.triangles += own / width;
      return;
    }
    if (found_.triangles >= enough_) return;
    std::vector<int> closer;
    std::ranges::copy_if(candidates, std::back_inserter(closer),
                         [&](int other) { return distance(middle, segment(other)) <= width + own; });
    const double half = 0.5 * (piece.begin + piece.end);
    add({piece.edge, piece.begin, half}, closer);
    add({piece.edge, half, piece.end}, closer);
  }

  const Rings& rings_;
  const double enough_;
  std::vector<bool> domain_on_the_left_;  ///< of the edges of each ring
  std::vector<std::vector<int>> near_;
  std::array<int, 2> last_pair_{};
  double closest_ = 0;
  int opposite_ = 0;
  NarrowPlaces found_;
};

}  // namespace

std::optional<std::array<int, 2>> pair_of_near_edges(const Rings& unit, std::size_t most) {
  std::size_t pairs = 0;
  std::optional<std::array<int, 2>> last;
  for_each_near_pair(unit, [&](int i, int j) {
    if (++pairs > most) last = {i, j};
    return !last;
  });
  return last;
}

NarrowPlaces narrow_places(const Rings& unit, double enough) {
  return Count(unit, enough).run();
}

}  // namespace signorini
