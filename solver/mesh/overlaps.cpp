#include "mesh/overlaps.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "mesh/fault_list.hpp"
#include "mesh/meeting_boxes.hpp"
#include "mesh/segments.hpp"
#include "progress/progress.hpp"

namespace signorini {
namespace {

/// The triangles cover a point as often as the boundary winds around it, for inner edges cancel in the sum
/// over the triangles. If the boundary's edges do not cross or touch, that number is the same between them;
/// so it is enough to look at the boundary: it must be 1 on the left of every edge, and 0 on its right.
class Boundary {
 public:
  Boundary(const EdgeTable& table, const std::vector<Point>& given, const std::vector<Point>& scaled)
      : given_(given), scaled_(scaled) {
    table.for_each_edge([&](std::span<const TriangleEdge> entries) {
      if (entries.size() == 1) edges_.push_back(entries[0]);
    });
    for (const TriangleEdge& edge : edges_) {
      const auto [from, to] = edge.directed();
      segments_.push_back({scaled[from], scaled[to]});
      turned_.push_back({turned(scaled[from]), turned(scaled[to])});
      lengths_.push_back((scaled[to] - scaled[from]).norm());
    }
    double farthest = 0;
    for (const Point& x : scaled) farthest = std::max(farthest, x.cwiseAbs().maxCoeff());
    rounding_ = 4 * std::numeric_limits<double>::epsilon() * farthest;
  }

  std::vector<Fault> faults(Progress* progress) {
    const bool are_all_seen = find_contacts(progress);
    std::vector<Fault> all;
    const bool simple = are_all_seen && touching_.is_empty() && overlapping_.is_empty();
    std::move(touching_).append_to(all);
    if (simple) find_covered_edges(progress);
    std::move(overlapping_).append_to(all);
    return all;
  }

 private:
  static Point turned(const Point& x) { return {x.y(), -x.x()}; }

  /// Up to this distance a point counts as lying on the edge.
  double tolerance(int edge) const { return 1e-9 * lengths_[edge] + rounding_; }

  std::string name(int edge) const {
    const auto& [a, b] = edges_[edge].points;
    return std::to_string(a) + "-" + std::to_string(b) + " of triangle " +
           std::to_string(edges_[edge].triangle);
  }

  /// Without a progress, among so many pairs at most, and false if there are more: slivers side by side, or
  /// triangles around one point, all have boxes that meet, and the solve looks at them.
  bool find_contacts(Progress* progress) {
    constexpr int most_pairs = 300'000;
    std::vector<Box> boxes;
    for (int e = 0; e < static_cast<int>(segments_.size()); ++e)
      boxes.push_back(box_around(segments_[e], tolerance(e)));
    int pairs = 0;
    for_each_meeting_pair(boxes, [&](int i, int j) {
      if (progress) progress->check_in(pairs);
      if (++pairs == most_pairs && !progress) return false;
      if (are_apart(i, j) || are_apart(j, i)) return true;
      const bool touch = touches(i, j) || touches(j, i);
      if (!touch && !share_a_point(i, j) && cross(segments_[i], segments_[j]))
        add_overlap(i, "overlaps triangle " + std::to_string(edges_[j].triangle) + ": the edges " + name(i) +
                           " and " + name(j) + " cross");
      return !touching_.is_full() && !overlapping_.is_full();
    });
    return progress || pairs < most_pairs;
  }

  /// Whether both ends of the second edge lie clearly on one side of the first one's line.
  bool are_apart(int first, int second) const {
    const auto& [a, b] = segments_[first];
    const double clearly = 2 * (tolerance(first) + tolerance(second)) * lengths_[first];
    const double one = twice_area(a, b, segments_[second][0]), other = twice_area(a, b, segments_[second][1]);
    return (one > clearly && other > clearly) || (one < -clearly && other < -clearly);
  }

  bool share_a_point(int i, int j) const {
    return std::ranges::any_of(edges_[i].points, [&](int p) { return is_end(p, j); });
  }

  bool is_end(int point, int edge) const { return std::ranges::count(edges_[edge].points, point) > 0; }

  /// Whether an end of the first edge lies on the second without being an end of it.
  bool touches(int first, int second) {
    bool any = false;
    for (const int point : edges_[first].points) {
      if (is_end(point, second) || distance(scaled_[point], segments_[second]) > tolerance(second)) continue;
      any = true;
      if (reported_.insert({point, second}).second) add_touch(point, second);
    }
    return any;
  }

  void add_touch(int point, int edge) {
    const std::string where = "/domain/points/" + std::to_string(point);
    for (const int end : edges_[edge].points)
      if ((scaled_[end] - scaled_[point]).norm() <= tolerance(edge))
        return touching_.add(where, "repeats point " + std::to_string(end) + " at " + to_string(given_[end]) +
                                        "; give a point once only");
    touching_.add(where, "is a hanging node at " + to_string(given_[point]) + ": it lies inside the edge " +
                             name(edge) + "; cut that triangle there");
  }

  void add_overlap(int edge, std::string detail) {
    overlapping_.add("/domain/triangles/" + std::to_string(edges_[edge].triangle), std::move(detail));
  }

  /// One edge tells for all that follow it without a fork.
  void find_covered_edges(Progress* progress) {
    const std::vector<int> chosen = longest_of_chains();
    std::vector<int> covered(edges_.size(), 0);
    for (const bool steep : {true, false}) count_coverings(chosen, steep, covered, progress);
    for (const int edge : chosen) {
      if (overlapping_.is_full()) return;
      if (covered[edge] != 1)
        add_overlap(edge, "overlaps another triangle: its edge " + name(edge) + " lies inside the mesh");
    }
  }

  bool is_steep(int edge) const {
    const Vector along = segments_[edge][1] - segments_[edge][0];
    return std::abs(along.y()) > std::abs(along.x());
  }

  /// How many triangles cover the left of each of the chosen edges that are steep, or are not: these are
  /// turned.
  void count_coverings(const std::vector<int>& chosen, bool steep, std::vector<int>& covered,
                       Progress* progress) const {
    const std::vector<Segment>& all = steep ? segments_ : turned_;
    std::vector<int> asked;
    std::vector<Point> middles;
    for (const int edge : chosen)
      if (is_steep(edge) == steep) {
        asked.push_back(edge);
        middles.push_back(0.5 * (all[edge][0] + all[edge][1]));
      }
    const std::vector<int> turns = winding_numbers(middles, all, progress);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const Segment& own = all[asked[i]];
      // The ray to the right of the midpoint begins on the right of an edge that rises, left of one that
      // falls.
      const int behind = turns[i] - winding_number(middles[i], {own});
      covered[asked[i]] = own[1].y() > own[0].y() ? behind + 1 : behind;
    }
  }

  std::vector<int> longest_of_chains() const {
    std::vector<int> leaving(scaled_.size(), 0), following(scaled_.size(), -1), chosen;
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
      ++leaving[edges_[e].directed()[0]];
      following[edges_[e].directed()[0]] = e;
    }
    std::vector<bool> seen(edges_.size(), false);
    const auto take_chain = [&](int first) {
      int longest = first;
      for (int e = first; !seen[e];) {
        seen[e] = true;
        if (lengths_[e] > lengths_[longest]) longest = e;
        const int end = edges_[e].directed()[1];
        if (leaving[end] == 1) e = following[end];
      }
      chosen.push_back(longest);
    };
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e)
      if (leaving[edges_[e].directed()[0]] > 1) take_chain(e);
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e)
      if (!seen[e]) take_chain(e);
    return chosen;
  }

  const std::vector<Point>& given_;
  const std::vector<Point>& scaled_;
  double rounding_ = 0;
  std::vector<TriangleEdge> edges_;
  std::vector<Segment> segments_, turned_;  // along the boundary, the domain on the left
  std::vector<double> lengths_;
  std::set<std::pair<int, int>> reported_;
  FaultList touching_{"/domain/points", "more hanging nodes or repeated points"};
  FaultList overlapping_{"/domain/triangles", "more overlaps"};
};

}  // namespace

std::vector<Fault> faults_of_overlap(const EdgeTable& edges, const std::vector<Point>& given,
                                     const std::vector<Point>& scaled, Progress* progress) {
  return Boundary(edges, given, scaled).faults(progress);
}

}  // namespace signorini
