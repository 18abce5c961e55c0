#include "mesh/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mesh/make_mesh.hpp"

namespace signorini {
namespace {

/// One side of one triangle, filed under its smaller point.
struct HalfEdge {
  int far_point;
  int triangle;
  int local;
};

/// Half-edges sorted into one bucket for each smaller point; a bucket holds about six.
class HalfEdges {
 public:
  HalfEdges(const Mesh& mesh, Progress* progress) : begin_(mesh.points.size() + 1, 0) {
    for_each(mesh, progress, [&](int near, const HalfEdge&) { ++begin_[near + 1]; });
    for (std::size_t p = 1; p < begin_.size(); ++p) begin_[p] += begin_[p - 1];
    entries_.resize(3 * mesh.triangles.size());
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for_each(mesh, progress, [&](int near, const HalfEdge& half) { entries_[next[near]++] = half; });
    for (int p = 0; p + 1 < static_cast<int>(begin_.size()); ++p) {
      if (progress) progress->check_in(p);
      std::stable_sort(entries_.begin() + begin_[p], entries_.begin() + begin_[p + 1],
                       [](const HalfEdge& a, const HalfEdge& b) { return a.far_point < b.far_point; });
    }
  }

  int begin(int near) const { return begin_[near]; }
  int end(int near) const { return begin_[near + 1]; }
  const HalfEdge& operator[](int i) const { return entries_[i]; }

 private:
  template <typename Visit>
  static void for_each(const Mesh& mesh, Progress* progress, Visit visit) {
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
      if (progress) progress->check_in(t);
      for (int e = 0; e < 3; ++e) {
        const auto [a, b] = std::minmax(mesh.triangles[t][(e + 1) % 3], mesh.triangles[t][(e + 2) % 3]);
        visit(a, HalfEdge{b, t, e});
      }
    }
  }

  std::vector<int> begin_;
  std::vector<HalfEdge> entries_;
};

void number_edges(Mesh& mesh, const HalfEdges& halves, Progress* progress) {
  mesh.triangle_edges.resize(mesh.triangles.size());
  // As many as there are (Euler), but for holes and bodies.
  const std::size_t about = mesh.points.size() + mesh.triangles.size();
  mesh.edges.reserve(about);
  mesh.edge_triangles.reserve(about);
  for (int near = 0; near < static_cast<int>(mesh.points.size()); ++near) {
    if (progress) progress->check_in(near);
    for (int i = halves.begin(near); i < halves.end(near); ++i) {
      const HalfEdge& half = halves[i];
      const bool second_side = i > halves.begin(near) && halves[i - 1].far_point == half.far_point;
      if (second_side) {
        if (mesh.edge_triangles.back()[1] >= 0) throw std::logic_error("an edge has three triangles");
        mesh.edge_triangles.back()[1] = half.triangle;
      } else {
        mesh.edges.push_back({near, half.far_point});
        mesh.edge_triangles.push_back({half.triangle, -1});
      }
      mesh.triangle_edges[half.triangle][half.local] = static_cast<int>(mesh.edges.size()) - 1;
    }
  }
}

int find_edge(const Mesh& mesh, std::array<int, 2> ends) {
  std::ranges::sort(ends);
  // Edges are numbered in lexicographic order of their ends.
  const auto found = std::ranges::lower_bound(mesh.edges, ends);
  if (found == mesh.edges.end() || *found != ends)
    throw std::logic_error("a boundary segment is no edge of the mesh");
  return static_cast<int>(found - mesh.edges.begin());
}

}  // namespace

Point Circle::nearest(const Point& x) const {
  const Vector out = x - centre;
  const double distance = out.norm();
  const double rounding =
      4 * std::numeric_limits<double>::epsilon() * (radius + centre.cwiseAbs().maxCoeff());
  if (std::abs(distance - radius) <= rounding) return x;
  return x + (radius / distance - 1) * out;
}

double Mesh::length(int edge) const {
  return (points[edges[edge][1]] - points[edges[edge][0]]).norm();
}

int Mesh::local_edge(int triangle, int edge) const {
  const auto& own = triangle_edges[triangle];
  return static_cast<int>(std::ranges::find(own, edge) - own.begin());
}

Vector Mesh::outward_normal(int edge) const {
  const int t = edge_triangles[edge][0];
  const int e = local_edge(t, edge);
  // A triangle that runs counter-clockwise has its outside on the right of each of its edges.
  const Vector along = points[triangles[t][(e + 2) % 3]] - points[triangles[t][(e + 1) % 3]];
  return Vector(along.y(), -along.x()).normalized();
}

double Mesh::rounding_of_normal(int edge) const {
  // Points that were put on a line by halving or by an intersection are off it by a few units in the last
  // place.
  constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();
  const auto& [a, b] = edges[edge];
  return rounding * std::max(points[a].cwiseAbs().maxCoeff(), points[b].cwiseAbs().maxCoeff()) / length(edge);
}

Point Mesh::middle(int edge) const {
  const auto& [a, b] = edges[edge];
  const Point middle = 0.5 * (points[a] + points[b]);
  const int circle = circle_of(edge);
  return circle < 0 ? middle : circles[circle].nearest(middle);
}

Mesh::BoundaryPoint Mesh::on_boundary(int edge, double s) const {
  const auto& [a, b] = edges[edge];
  const Point x = s == 1 ? points[b] : Point(points[a] + s * (points[b] - points[a]));
  const Vector normal = outward_normal(edge);
  const int circle = circle_of(edge);
  if (circle < 0) return {x, normal};
  const Vector from_centre = (x - circles[circle].centre).normalized();
  const Vector of_arc = from_centre.dot(normal) > 0 ? from_centre : Vector(-from_centre);
  return {circles[circle].nearest(x), of_arc};
}

Point Mesh::centroid(int triangle) const {
  const auto& [a, b, c] = triangles[triangle];
  return (points[a] + points[b] + points[c]) / 3;
}

double Mesh::diameter() const {
  Point low = points[0], high = low;
  for (const Point& x : points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return (high - low).norm();
}

double Mesh::area() const {
  double sum = 0;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const auto [a, b, c] = corners(t);
    const Vector ab = b - a, ac = c - a;
    sum += 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
  }
  return sum;
}

std::size_t Mesh::bytes() const {
  const auto bytes_of = [](const auto& elements) { return elements.capacity() * sizeof(elements[0]); };
  std::size_t bytes = bytes_of(points) + bytes_of(triangles) + bytes_of(edges) + bytes_of(triangle_edges) +
                      bytes_of(edge_triangles) + bytes_of(circles) + bytes_of(edge_circles);
  for (const BoundaryPart& part : boundary) bytes += bytes_of(part.edges);
  return bytes;
}

Mesh make_mesh(std::vector<Point> points, std::vector<std::array<int, 3>> triangles,
               const std::vector<std::string>& part_names, const std::vector<BoundarySegment>& segments,
               std::vector<Circle> circles, Progress* progress) {
  Mesh mesh;
  mesh.points = std::move(points);
  mesh.triangles = std::move(triangles);
  number_edges(mesh, HalfEdges(mesh, progress), progress);
  for (const std::string& name : part_names) mesh.boundary.push_back({name, {}});
  mesh.circles = std::move(circles);
  if (!mesh.circles.empty()) mesh.edge_circles.assign(mesh.edges.size(), -1);
  for (const BoundarySegment& segment : segments) {
    const int edge = find_edge(mesh, segment.points);
    mesh.boundary[segment.part].edges.push_back(edge);
    if (segment.circle >= 0) mesh.edge_circles[edge] = segment.circle;
  }
  return mesh;
}

Mesh make_mesh(std::vector<Point> points, std::vector<std::array<int, 3>> triangles,
               const std::vector<std::string>& part_names, const std::vector<BoundarySegment>& segments,
               std::vector<Circle> circles) {
  return make_mesh(std::move(points), std::move(triangles), part_names, segments, std::move(circles),
                   nullptr);
}

}  // namespace signorini
