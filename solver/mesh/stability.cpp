#include "mesh/stability.hpp"

#include <algorithm>

#include "mesh/parts.hpp"
#include "mesh/refine.hpp"

namespace signorini {
namespace {

using Triangle = std::array<int, 3>;

bool is_boundary(const Mesh& mesh, int edge) {
  return mesh.edge_triangles[edge][1] < 0;
}

/// Cuts triangles at points added to some of their edges, or at their centroid.
class CornerSplit {
 public:
  explicit CornerSplit(const Mesh& mesh)
      : mesh_(mesh), points_(mesh.points), midpoint_(mesh.edges.size(), -1) {}

  Mesh mesh() {
    halve_corners();
    if (points_.size() == mesh_.points.size() && isolated_ == 0) return mesh_;
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) cut(t);
    return make_mesh(std::move(points_), std::move(triangles_), names(mesh_.boundary), segments());
  }

 private:
  int boundary_edges(int triangle) const {
    return static_cast<int>(std::ranges::count_if(mesh_.triangle_edges[triangle],
                                                  [&](int edge) { return is_boundary(mesh_, edge); }));
  }

  void halve_corners() {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      const int sides = boundary_edges(t);
      if (sides == 3) ++isolated_;
      if (sides != 2) continue;
      for (const int edge : mesh_.triangle_edges[t])
        if (!is_boundary(mesh_, edge) && midpoint_[edge] < 0) midpoint_[edge] = add(midpoint_of(edge));
    }
  }

  Point midpoint_of(int edge) const {
    return 0.5 * (mesh_.points[mesh_.edges[edge][0]] + mesh_.points[mesh_.edges[edge][1]]);
  }

  int add(const Point& x) {
    points_.push_back(x);
    return static_cast<int>(points_.size()) - 1;
  }

  int middle(int triangle, int local) const { return midpoint_[mesh_.triangle_edges[triangle][local]]; }

  void cut(int t) {
    int halved = 0;
    for (int e = 0; e < 3; ++e) halved += middle(t, e) >= 0;
    if (halved == 0) boundary_edges(t) == 3 ? cut_at_centroid(t) : keep(t);
    if (halved == 1) cut_in_two(t);
    if (halved == 2) cut_in_three(t);
    if (halved == 3) cut_in_four(t);
  }

  void keep(int t) { triangles_.push_back(mesh_.triangles[t]); }

  void cut_at_centroid(int t) {
    const auto [a, b, c] = mesh_.triangles[t];
    const int m = add((mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3);
    triangles_.insert(triangles_.end(), {{a, b, m}, {b, c, m}, {c, a, m}});
  }

  void cut_in_two(int t) {
    int e = 0;
    while (middle(t, e) < 0) ++e;
    const auto [a, b, c] = from(t, e);
    const int bc = middle(t, e);
    triangles_.insert(triangles_.end(), {{a, b, bc}, {a, bc, c}});
  }

  void cut_in_three(int t) {
    int e = 0;
    while (middle(t, e) >= 0) ++e;
    const auto [a, b, c] = from(t, e);
    const int ca = middle(t, (e + 1) % 3), ab = middle(t, (e + 2) % 3);
    triangles_.push_back({a, ab, ca});
    // The shorter diagonal of what is left leaves the larger angles.
    if (squared(ab, c) < squared(b, ca))
      triangles_.insert(triangles_.end(), {{ab, b, c}, {ab, c, ca}});
    else
      triangles_.insert(triangles_.end(), {{ab, b, ca}, {b, c, ca}});
  }

  void cut_in_four(int t) {
    const auto [a, b, c] = mesh_.triangles[t];
    const int bc = middle(t, 0), ca = middle(t, 1), ab = middle(t, 2);
    triangles_.insert(triangles_.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }

  /// The triangle, its vertices listed from a given one on.
  Triangle from(int t, int first) const {
    Triangle triangle = mesh_.triangles[t];
    std::rotate(triangle.begin(), triangle.begin() + first, triangle.end());
    return triangle;
  }

  double squared(int p, int q) const { return (points_[p] - points_[q]).squaredNorm(); }

  /// No edge of the boundary is cut.
  std::vector<BoundarySegment> segments() const {
    std::vector<BoundarySegment> all;
    for (int part = 0; part < static_cast<int>(mesh_.boundary.size()); ++part)
      for (const int edge : mesh_.boundary[part].edges) all.push_back({mesh_.edges[edge], part});
    return all;
  }

  const Mesh& mesh_;
  int isolated_ = 0;
  std::vector<Point> points_;
  std::vector<int> midpoint_;  // of each edge, -1 where it stays whole
  std::vector<Triangle> triangles_;
};

}  // namespace

Mesh split_corners(const Mesh& mesh) {
  return CornerSplit(mesh).mesh();
}

Mesh mend(const Mesh& mesh) {
  Mesh mended = split_corners(mesh);
  const bool has_corners = mended.triangles.size() > mesh.triangles.size();
  if (!has_corners) mended = refine(mesh, 1);
  mended.notes = mesh.notes;
  mended.notes.push_back(
      "the spaces for elasticity are not stable on " + std::to_string(mesh.triangles.size()) + " triangles: " +
      (has_corners ? "those with several sides on the boundary were split" : "each was cut into four") +
      ", which makes " + std::to_string(mended.triangles.size()));
  return mended;
}

}  // namespace signorini
