#include "mesh/narrow_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "mesh/meeting_boxes.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// An edge as its distance is asked for.
struct Edge {
  explicit Edge(const Segment& ends)
      : begin(ends[0]), way(ends[1] - ends[0]), length(way.norm()), inverse(1 / way.squaredNorm()) {}

  /// The vector from the nearest point to x.
  Vector to(const Point& x) const {
    const Vector from_begin = x - begin;
    return from_begin - std::clamp(from_begin.dot(way) * inverse, 0.0, 1.0) * way;
  }

  /// Whether another that does not cross it is farther away: mostly its line already says so.
  bool is_farther(const Edge& other, double distance) const {
    const auto from_line = [&](const Point& x) {
      return (way.x() * (x.y() - begin.y()) - way.y() * (x.x() - begin.x())) / length;
    };
    const Point end = other.begin + other.way;
    const double one = from_line(other.begin), two = from_line(end);
    if (std::min(one, two) > distance || std::max(one, two) < -distance) return true;
    return std::min({other.to(begin).squaredNorm(), other.to(begin + way).squaredNorm(),
                     to(other.begin).squaredNorm(), to(end).squaredNorm()}) > distance * distance;
  }

  Point begin;
  Vector way;
  double length, inverse;
};

class Count {
 public:
  Count(const Rings& unit, const EdgePairs& near, double enough) : rings_(unit), enough_(enough) {
    for (int ring = 0; ring < unit.size(); ++ring)
      domain_on_the_left_.push_back(unit.has_domain_on_the_left(ring));
    for (int edge = 0; edge < static_cast<int>(unit.points.size()); ++edge)
      edges_.emplace_back(unit.edge(edge));
    sort_by_edge(near);
    found_.stretches.reserve(edges_.size());
  }

  NarrowPlaces run() {
    double most = 0;
    for (int edge = 0; edge < static_cast<int>(edges_.size()) && found_.triangles < enough_; ++edge) {
      const double before = found_.triangles;
      closest_ = edges_[edge].length;
      near_.assign(neighbours_.begin() + first_neighbour_[edge],
                   neighbours_.begin() + first_neighbour_[edge + 1]);
      add({edge, 0, 1}, 0);
      if (found_.triangles - before <= most) continue;
      most = found_.triangles - before;
      found_.edge = edge;
      found_.opposite = opposite_;
    }
    return std::move(found_);
  }

 private:
  /// The part of an edge between two shares of its way.
  struct Piece {
    int edge;
    double begin, end;
  };

  /// The other edges closer to an edge than it is long.
  void sort_by_edge(const EdgePairs& pairs) {
    first_neighbour_.assign(edges_.size() + 1, 0);
    for (const auto& [i, j] : pairs) ++first_neighbour_[i], ++first_neighbour_[j];
    // From here on where the neighbours of each edge end, and when all are there, where they begin.
    std::partial_sum(first_neighbour_.begin(), first_neighbour_.end(), first_neighbour_.begin());
    neighbours_.resize(2 * pairs.size());
    for (const auto& [i, j] : pairs) {
      neighbours_[--first_neighbour_[i]] = j;
      neighbours_[--first_neighbour_[j]] = i;
    }
  }

  /// Whether a point on an edge sees another one, at this vector from the nearest point of it, across the
  /// domain.
  bool is_across(const Point& x, int edge, int other, const Vector& from_other) const {
    const Edge& own = edges_[edge];
    const bool before = rings_.next(other) == edge, behind = rings_.next(edge) == other;
    if (before || behind) {
      const double to_tip = (x - (before ? own.begin : Point(own.begin + own.way))).norm();
      constexpr double half = 0.5 * (1 - 1e-9);  // where edges are halved, rounding has no say
      if (to_tip < half * std::min(own.length, edges_[other].length)) return false;
    }
    return faces(edge, -from_other) && faces(other, x - edges_[other].begin);
  }

  /// Whether a way from a point of an edge leads to the side of the domain.
  bool faces(int edge, const Vector& way) const {
    const Vector& along = edges_[edge].way;
    const double to_the_left = along.x() * way.y() - along.y() * way.x();
    return domain_on_the_left_[rings_.ring[edge]] ? to_the_left > 0 : to_the_left < 0;
  }

  /// The distance, at most, of any point of a part of an edge from the other edges across the domain:
  /// `nearest` is so far from the middle.
  double most_across(int edge, const Edge& part, int nearest, double distance) const {
    if (nearest < 0) return distance + part.length / 2;
    double most = 0;
    for (const Point& end : {part.begin, Point(part.begin + part.way)}) {
      const Vector from_nearest = edges_[nearest].to(end);
      if (!is_across(end, edge, nearest, from_nearest)) return distance + part.length / 2;
      most = std::max(most, from_nearest.norm());
    }
    return most;
  }

  /// The distance of the ends of a piece from the edge that is nearest to its middle, or that of the middle.
  double least_width(const Piece& piece, int nearest, double of_middle) const {
    const Edge& edge = edges_[piece.edge];
    double least = of_middle;
    for (const double share : {piece.begin, piece.end}) {
      const Point end = edge.begin + share * edge.way;
      const Vector from_nearest = edges_[nearest].to(end);
      if (is_across(end, piece.edge, nearest, from_nearest)) least = std::min(least, from_nearest.norm());
    }
    return least;
  }

  /// Whether two edges are sides of a rectangle, so that both are cut at the same places.
  static bool is_mirrored(const Edge& one, const Edge& other) {
    constexpr double rounding = 1e-6;
    const Vector from_end = one.begin - (other.begin + other.way),
                 from_begin = one.begin + one.way - other.begin;
    return std::abs(from_end.dot(one.way)) <= rounding / one.inverse &&
           (from_end - from_begin).squaredNorm() <= rounding * rounding * from_end.squaredNorm();
  }

  /// Whether a vertex across comes much closer to a piece than the piece is long: of the edges in near_ from
  /// `first` on.
  bool is_narrow_within(const Piece& piece, std::size_t first) const {
    constexpr double much = 8;
    const Edge& edge = edges_[piece.edge];
    const double closest = edge.length * (piece.end - piece.begin) / much;
    for (std::size_t i = first; i < near_.size(); ++i) {
      if (near_[i] == rings_.next(piece.edge)) continue;  // begins where this edge ends
      const Vector to_vertex = edges_[near_[i]].begin - edge.begin;
      const double share = to_vertex.dot(edge.way) * edge.inverse;
      if (share <= piece.begin || share >= piece.end || !faces(piece.edge, to_vertex)) continue;
      if ((to_vertex - share * edge.way).squaredNorm() < closest * closest) return true;
    }
    return false;
  }

  void keep(const NarrowPlaces::Stretch& stretch) {
    const auto about = [](double width) { return std::floor(8 * std::log2(width)); };
    NarrowPlaces::Stretch* const last = found_.stretches.empty() ? nullptr : &found_.stretches.back();
    if (!last || last->edge != stretch.edge || last->length != stretch.length ||
        last->is_mirrored != stretch.is_mirrored || about(last->width) != about(stretch.width)) {
      found_.stretches.push_back(stretch);
      return;
    }
    last->width = std::min(last->width, stretch.width);
    last->least = std::min(last->least, stretch.least);
    ++last->parts;
  }

  /// `first`: the place in near_ from which on the edges stand that may be closest to a point of the piece.
  void add(const Piece& piece, std::size_t first) {
    const Edge& edge = edges_[piece.edge];
    const double whole = edge.length, own = whole * (piece.end - piece.begin);
    const Point middle = edge.begin + 0.5 * (piece.begin + piece.end) * edge.way;
    double width = whole;
    int nearest = -1;
    const std::size_t last = near_.size();
    squares_.resize(last);
    for (std::size_t i = first; i < last; ++i) {
      const Vector from_other = edges_[near_[i]].to(middle);
      squares_[i] = from_other.squaredNorm();
      const double most = std::max(width, closest_);
      if (squares_[i] >= most * most || !is_across(middle, piece.edge, near_[i], from_other)) continue;
      const double distance = std::sqrt(squares_[i]);
      if (distance < closest_) closest_ = distance, opposite_ = near_[i];
      if (distance < width) width = distance, nearest = near_[i];
    }
    constexpr double steps = 4;  // of a piece, that its middle speaks for
    if (own <= steps * width && !is_narrow_within(piece, first)) {
      const bool is_narrow = width < whole;
      if (is_narrow) found_.triangles += own / width;
      constexpr double infinity = std::numeric_limits<double>::infinity();
      keep({piece.edge, own, is_narrow ? width : infinity,
            is_narrow ? least_width(piece, nearest, width) : infinity, 1,
            is_narrow && is_mirrored(edge, edges_[nearest])});
      return;
    }
    if (found_.triangles >= enough_) return;
    const Edge part({edge.begin + piece.begin * edge.way, edge.begin + piece.end * edge.way});
    constexpr double rounding = 1 + 1e-9;
    const double most = rounding * most_across(piece.edge, part, nearest, width), reach = most + own / 2;
    for (std::size_t i = first; i < last; ++i)
      if (squares_[i] <= reach * reach && !part.is_farther(edges_[near_[i]], most)) near_.push_back(near_[i]);
    const double half = 0.5 * (piece.begin + piece.end);
    add({piece.edge, piece.begin, half}, last);
    add({piece.edge, half, piece.end}, last);
    near_.resize(last);
  }

  const Rings& rings_;
  const double enough_;
  std::vector<bool> domain_on_the_left_;  ///< of the edges of each ring
  std::vector<Edge> edges_;
  std::vector<int> neighbours_, first_neighbour_;  ///< of all edges, one after the other
  std::vector<int> near_;        ///< the neighbours of the edge at hand, and behind them those of its pieces
  std::vector<double> squares_;  ///< of their distances
  double closest_ = 0;           ///< to the edge at hand, of those across that are closer than it is long
  int opposite_ = 0;
  NarrowPlaces found_;
};

}  // namespace

EdgePairs near_edges(const Rings& unit, std::size_t most) {
  std::vector<Box> boxes;
  boxes.reserve(unit.points.size());
  for (int edge = 0; edge < static_cast<int>(unit.points.size()); ++edge) {
    const Segment ends = unit.edge(edge);
    boxes.push_back(box_around(ends, (ends[1] - ends[0]).norm() / 2));
  }
  EdgePairs pairs;
  pairs.reserve(most);
  for_each_meeting_pair(boxes, [&](int i, int j) {
    pairs.push_back({i, j});
    return pairs.size() < most;
  });
  return pairs;
}

NarrowPlaces narrow_places(const Rings& unit, const EdgePairs& near, double enough) {
  return Count(unit, near, enough).run();
}

}  // namespace signorini
