#include "mesh/bisect.hpp"

#include <algorithm>

#include "mesh/corner_order.hpp"
#include "mesh/make_mesh.hpp"
#include "mesh/parts.hpp"
#include "mesh/upright.hpp"

namespace signorini {
namespace {

using Triangle = std::array<int, 3>;

/// Whether each edge is halved: those of the marked triangles, and with any edge of a triangle the one
/// opposite its first vertex. Edges are only added, so that this ends for every mesh.
std::vector<bool> halved_edges(const Mesh& mesh, const std::vector<int>& marked) {
  std::vector<bool> halved(mesh.edges.size(), false);
  std::vector<int> added;
  const auto halve = [&](int edge) {
    if (halved[edge]) return;
    halved[edge] = true;
    added.push_back(edge);
  };
  for (const int t : marked) std::ranges::for_each(mesh.triangle_edges[t], halve);
  while (!added.empty()) {
    const int edge = added.back();
    added.pop_back();
    for (const int t : mesh.edge_triangles[edge])
      if (t >= 0) halve(mesh.triangle_edges[t][0]);
  }
  return halved;
}

/// Where the middle of an arc's chord goes.
enum class Middle { on_arc, on_chord };

class Bisection {
 public:
  Bisection(const Mesh& mesh, const std::vector<int>& marked, Middle of_arcs)
      : mesh_(mesh), points_(mesh.points), middle_(mesh.edges.size(), -1) {
    const std::vector<bool> halved = halved_edges(mesh, marked);
    for (int edge = 0; edge < static_cast<int>(halved.size()); ++edge) {
      if (!halved[edge]) continue;
      const auto& [a, b] = mesh.edges[edge];
      middle_[edge] = static_cast<int>(points_.size());
      points_.push_back(of_arcs == Middle::on_arc ? mesh.middle(edge)
                                                  : Point(0.5 * (mesh.points[a] + mesh.points[b])));
    }
  }

  const std::vector<int>& parents() const { return parents_; }

  Mesh mesh(Progress* progress) {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      if (progress) progress->check_in(t);
      cut(t);
      parents_.resize(triangles_.size(), t);
    }
    Mesh mesh = make_mesh(std::move(points_), std::move(triangles_), names(mesh_.boundary), segments(),
                          mesh_.circles, progress);
    mesh.notes = mesh_.notes;
    return mesh;
  }

 private:
  void cut(int t) {
    const auto& [a, b, c] = mesh_.triangles[t];
    const auto& [bc, ca, ab] = mesh_.triangle_edges[t];
    const int m = middle_[bc];
    if (m < 0) return triangles_.push_back(mesh_.triangles[t]);
    add({m, a, b}, middle_[ab]);
    add({m, c, a}, middle_[ca]);
  }

  /// A triangle, or its halves if the edge opposite its first vertex has a middle.
  void add(const Triangle& triangle, int middle) {
    const auto& [a, b, c] = triangle;
    if (middle < 0) return triangles_.push_back(triangle);
    triangles_.push_back({middle, a, b});
    triangles_.push_back({middle, c, a});
  }

  std::vector<BoundarySegment> segments() const {
    std::vector<BoundarySegment> all;
    for (int part = 0; part < static_cast<int>(mesh_.boundary.size()); ++part) {
      const auto directed = directed_edges(mesh_, mesh_.boundary[part]);
      for (std::size_t i = 0; i < directed.size(); ++i) {
        const auto& [a, b] = directed[i];
        const int edge = mesh_.boundary[part].edges[i], m = middle_[edge], circle = mesh_.circle_of(edge);
        if (m < 0) {
          all.push_back({{a, b}, part, circle});
        } else {
          all.push_back({{a, m}, part, circle});
          all.push_back({{m, b}, part, circle});
        }
      }
    }
    return all;
  }

  const Mesh& mesh_;
  std::vector<Point> points_;
  std::vector<int> middle_;  // the number of the middle of each edge, -1 where it stays whole
  std::vector<Triangle> triangles_;
  std::vector<int> parents_;
};

/// Of each triangle the corner `first_of(mesh, triangle)` comes first.
template <typename FirstOf>
Mesh turned(Mesh mesh, const FirstOf& first_of) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = first_of(mesh, t);
    std::rotate(mesh.triangle_edges[t].begin(), mesh.triangle_edges[t].begin() + first,
                mesh.triangle_edges[t].end());
    std::rotate(mesh.triangles[t].begin(), mesh.triangles[t].begin() + first, mesh.triangles[t].end());
  }
  return mesh;
}

}  // namespace

Mesh with_longest_edges_first(Mesh mesh) {
  return turned(std::move(mesh), [](const Mesh& of, std::size_t t) {
    const auto& edges = of.triangle_edges[t];
    return std::ranges::max_element(edges, {}, [&](int edge) { return std::pair(of.length(edge), edge); }) -
           edges.begin();
  });
}

Mesh with_lowest_corners_first(Mesh mesh) {
  return turned(std::move(mesh), [](const Mesh& of, std::size_t t) {
    return std::ranges::find(of.triangles[t], from_lowest(of.triangles[t], of.points)[0]) -
           of.triangles[t].begin();
  });
}

Mesh bisect(const Mesh& mesh, const std::vector<int>& marked, Progress* progress) {
  Mesh finer = Bisection(mesh, marked, Middle::on_arc).mesh(progress);
  require_upright(finer);
  return finer;
}

Mesh bisect(const Mesh& mesh, const std::vector<int>& marked, std::vector<int>& parents, Progress* progress) {
  Bisection bisection(mesh, marked, Middle::on_chord);
  Mesh finer = bisection.mesh(progress);
  parents = bisection.parents();
  return finer;
}

}  // namespace signorini
