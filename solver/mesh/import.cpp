#include "mesh/import.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "mesh/chains.hpp"
#include "mesh/corner_order.hpp"
#include "mesh/edge_table.hpp"
#include "mesh/fault_list.hpp"
#include "mesh/make_mesh.hpp"
#include "mesh/overlaps.hpp"
#include "mesh/segments.hpp"
#include "mesh/unit_frame.hpp"
#include "mesh/wings.hpp"

namespace signorini {
namespace {

/// Below this area, relative to the squared longest edge, a triangle has no height to speak of.
constexpr double degenerate = 1e-8;

std::string pointer(const std::string& array, std::size_t index) {
  return array + '/' + std::to_string(index);
}

std::string joined(const auto& numbers) {
  std::string text;
  for (const int number : numbers) text += (text.empty() ? "" : "-") + std::to_string(number);
  return text;
}

/// A name as a token of a JSON pointer (RFC 6901).
std::string part_pointer(const std::string& name) {
  std::string token;
  for (const char c : name) token += c == '~' ? std::string("~0") : c == '/' ? "~1" : std::string(1, c);
  return "/domain/boundary/" + token;
}

/// Checks the data step by step, each of which relies on the ones before it, and builds the mesh.
class Import {
 public:
  Import(const MeshData& data, Progress* progress)
      : data_(data), progress_(progress), triangles_(data.triangles) {}

  Mesh mesh(bool is_sound) {
    check_names();
    check_points();
    check_numbers();
    throw_if_any();
    check_frame();
    check_repeated_points();
    check_unused_points();
    throw_if_any();
    check_shapes();
    check_repeated_triangles();
    throw_if_any();
    const EdgeTable edges(triangles_);
    check_edges(edges);
    throw_if_any();
    if (!is_sound) faults_ = faults_of_overlap(edges, data_.points, scaled_, progress_);
    throw_if_any();
    std::vector<Point> points = data_.points;
    std::vector<std::vector<std::array<int, 2>>> parts = edges_of_parts(edges);
    const std::string on_wings = separate_wings(points, triangles_, parts);
    Mesh mesh = make_mesh(std::move(points), std::move(triangles_), names_, segments(parts), {}, progress_);
    mesh.notes = data_.notes;
    if (!on_wings.empty()) mesh.notes.push_back(on_wings);
    return mesh;
  }

 private:
  /// After each step, none of which takes a tenth of a second for the largest mesh that a request can hold.
  void throw_if_any() const {
    if (progress_) progress_->check();
    if (faults_.empty()) return;
    if (data_.file.empty()) throw InvalidProblem(faults_);
    std::vector<Fault> in_file;
    for (const auto& [where, detail] : faults_)
      in_file.push_back({data_.file, where.substr(std::string_view("/domain/").size()) +
                                         ", counted from 0 in the file: " + detail});
    throw InvalidProblem(std::move(in_file));
  }

  bool exists(int point) const { return point >= 0 && point < static_cast<int>(data_.points.size()); }

  void check_names() {
    std::set<std::string> known;
    FaultList bad("/domain/boundary", "more names or parts that are none");
    for (const auto& [name, edges] : data_.boundary) {
      names_.push_back(name);
      const std::string where = part_pointer(name);
      if (name.empty()) bad.add(where, "the name of a part must not be empty");
      if (name == "all") bad.add(where, "is reserved for every part not named; choose another name");
      if (!known.insert(name).second) bad.add(where, "there are two parts of this name");
      if (edges.empty()) bad.add(where, "must have at least one edge");
    }
    std::move(bad).append_to(faults_);
  }

  void check_points() {
    if (data_.points.empty()) faults_.push_back({"/domain/points", "must not be empty"});
    if (data_.triangles.empty()) faults_.push_back({"/domain/triangles", "must not be empty"});
    FaultList infinite("/domain/points", "more points that are not finite");
    for (std::size_t p = 0; p < data_.points.size(); ++p)
      if (!data_.points[p].allFinite()) infinite.add(pointer("/domain/points", p), "must be finite");
    std::move(infinite).append_to(faults_);
  }

  void check_numbers() {
    FaultList bad("/domain/triangles", "more triangles of points that do not exist or are the same");
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (const std::string fault = fault_of_numbers(triangles_[t]); !fault.empty())
        bad.add(pointer("/domain/triangles", t), fault);
    std::move(bad).append_to(faults_);
    FaultList bad_edges("/domain/boundary", "more edges of points that do not exist or are the same");
    for (const auto& [name, edges] : data_.boundary)
      for (std::size_t i = 0; i < edges.size(); ++i)
        if (const std::string fault = fault_of_numbers(edges[i]); !fault.empty())
          bad_edges.add(pointer(part_pointer(name), i), fault);
    std::move(bad_edges).append_to(faults_);
  }

  template <std::size_t size>
  std::string fault_of_numbers(const std::array<int, size>& numbers) const {
    const auto missing = std::ranges::find_if_not(numbers, [&](int p) { return exists(p); });
    if (missing != numbers.end())
      return "there is no point " + std::to_string(*missing) + "; points are numbered from 0 to " +
             std::to_string(static_cast<int>(data_.points.size()) - 1);
    std::array<int, size> sorted = numbers;
    std::ranges::sort(sorted);
    const bool twice = std::ranges::adjacent_find(sorted) != sorted.end();
    return twice ? "names a point twice: " + joined(numbers) : std::string();
  }

  void check_frame() {
    if (const std::string reason = why_no_frame(data_.points); !reason.empty())
      faults_.push_back({"/domain/points", reason});
    throw_if_any();
    const UnitFrame frame(data_.points);
    for (const Point& x : data_.points) scaled_.push_back(frame.scaled(x));
  }

  void check_repeated_points() {
    std::vector<int> order(data_.points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int p) { return std::tuple(data_.points[p].x(), data_.points[p].y()); };
    std::ranges::stable_sort(order, {}, place);
    FaultList repeated("/domain/points", "more points that repeat another");
    for (std::size_t i = 1; i < order.size(); ++i)
      if (place(order[i - 1]) == place(order[i]))
        repeated.add(pointer("/domain/points", order[i]), "repeats point " + std::to_string(order[i - 1]) +
                                                              " at " + to_string(data_.points[order[i]]) +
                                                              "; give a point once only");
    std::move(repeated).append_to(faults_);
  }

  /// They are not dropped silently: the numbers in the result are those of the client.
  void check_unused_points() {
    std::vector<bool> used(data_.points.size(), false);
    for (const auto& triangle : triangles_)
      for (const int p : triangle) used[p] = true;
    FaultList unused("/domain/points", "more points that belong to no triangle");
    for (std::size_t p = 0; p < used.size(); ++p)
      if (!used[p]) unused.add(pointer("/domain/points", p), "belongs to no triangle; leave it out");
    std::move(unused).append_to(faults_);
  }

  /// Turns the triangles counter-clockwise, and so that those of one shape are alike.
  void check_shapes() {
    FaultList flat("/domain/triangles", "more degenerate triangles");
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto [a, b, c] = triangles_[t];
      const double twice = twice_area(scaled_[a], scaled_[b], scaled_[c]);
      const double longest =
          std::max({(scaled_[b] - scaled_[a]).squaredNorm(), (scaled_[c] - scaled_[b]).squaredNorm(),
                    (scaled_[a] - scaled_[c]).squaredNorm()});
      if (std::abs(twice) <= 2 * degenerate * longest)
        flat.add(pointer("/domain/triangles", t), "is degenerate: the points " + joined(data_.triangles[t]) +
                                                      " lie on a line near " + to_string(data_.points[a]));
      triangles_[t] = in_order(triangles_[t], scaled_);
    }
    std::move(flat).append_to(faults_);
  }

  void check_repeated_triangles() {
    FaultList repeated("/domain/triangles", "more triangles that repeat another");
    std::vector<std::pair<std::array<int, 3>, int>> sorted;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      sorted.push_back({triangles_[t], t});
      std::ranges::sort(sorted.back().first);
    }
    std::ranges::sort(sorted);
    for (std::size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i].first == sorted[i - 1].first)
        repeated.add(pointer("/domain/triangles", sorted[i].second),
                     "repeats triangle " + std::to_string(sorted[i - 1].second));
    std::move(repeated).append_to(faults_);
  }

  /// An edge has one triangle, or one on each side.
  void check_edges(const EdgeTable& edges) {
    FaultList bad("/domain/triangles", "more triangles that overlap at an edge");
    edges.for_each_edge([&](std::span<const TriangleEdge> entries) {
      const auto edge = [&] { return joined(entries[0].points); };
      if (entries.size() > 2)
        bad.add(pointer("/domain/triangles", entries[2].triangle),
                "is the third triangle on the edge " + edge() + ", after " +
                    std::to_string(entries[0].triangle) + " and " + std::to_string(entries[1].triangle));
      if (entries.size() == 2 && entries[0].forward == entries[1].forward)
        bad.add(pointer("/domain/triangles", entries[1].triangle), "overlaps triangle " +
                                                                       std::to_string(entries[0].triangle) +
                                                                       ": both lie on the same side of "
                                                                       "their edge " +
                                                                       edge());
    });
    std::move(bad).append_to(faults_);
  }

  std::vector<std::vector<std::array<int, 2>>> edges_of_parts(const EdgeTable& edges) {
    std::map<std::array<int, 2>, int> part_of_edge;
    std::vector<std::vector<std::array<int, 2>>> parts;
    FaultList bad("/domain/boundary", "more edges that are not on the boundary or are taken already");
    for (int part = 0; part < static_cast<int>(names_.size()); ++part)
      parts.push_back(edges_of_part(part, edges, part_of_edge, bad));
    std::move(bad).append_to(faults_);
    check_missing(edges, part_of_edge);
    throw_if_any();
    return parts;
  }

  static std::vector<BoundarySegment> segments(const std::vector<std::vector<std::array<int, 2>>>& parts) {
    std::vector<BoundarySegment> all;
    for (int part = 0; part < static_cast<int>(parts.size()); ++part)
      for (const auto& edge : in_chains(parts[part])) all.push_back({edge, part});
    return all;
  }

  /// The edges of a part, the domain on their left. Remembers the part that took an edge.
  std::vector<std::array<int, 2>> edges_of_part(int part, const EdgeTable& table,
                                                std::map<std::array<int, 2>, int>& part_of_edge,
                                                FaultList& bad) {
    const std::string where = part_pointer(names_[part]);
    std::vector<std::array<int, 2>> directed;
    const auto& edges = data_.boundary[part].second;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto entries = table.between(edges[i]);
      const std::string at = pointer(where, i), name = "the edge " + joined(edges[i]);
      if (entries.empty()) {
        bad.add(at, name + " is no edge of a triangle");
      } else if (entries.size() > 1) {
        bad.add(at, name + " is inside the domain, between triangles " + std::to_string(entries[0].triangle) +
                        " and " + std::to_string(entries[1].triangle));
      } else if (const auto taken = part_of_edge.insert({entries[0].points, part}); !taken.second) {
        bad.add(at, name + " is named already in " + part_pointer(names_[taken.first->second]));
      } else {
        directed.push_back(entries[0].directed());
      }
    }
    return directed;
  }

  void check_missing(const EdgeTable& edges, const std::map<std::array<int, 2>, int>& part_of_edge) {
    FaultList missing("/domain/boundary", "more edges of the boundary that no part has");
    edges.for_each_edge([&](std::span<const TriangleEdge> entries) {
      if (entries.size() > 1 || part_of_edge.contains(entries[0].points)) return;
      const auto& [a, b] = entries[0].points;
      missing.add("/domain/boundary", "no part has the edge " + joined(entries[0].points) +
                                          " of the boundary, from " + to_string(data_.points[a]) + " to " +
                                          to_string(data_.points[b]) +
                                          "; put it in one (a part without a condition is free)");
    });
    std::move(missing).append_to(faults_);
  }

  const MeshData& data_;
  Progress* const progress_;
  std::vector<std::array<int, 3>> triangles_;  // counter-clockwise, once checked
  std::vector<Point> scaled_;                  // in units in which the domain's extent is 1
  std::vector<std::string> names_;
  std::vector<Fault> faults_;
};

}  // namespace

Mesh import_mesh(const MeshData& data, Progress* progress) {
  return Import(data, progress).mesh(false);
}

Mesh import_sound_mesh(const MeshData& data) {
  return Import(data, nullptr).mesh(true);
}

}  // namespace signorini
