#include "api/picture/foundation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace signorini::api {
namespace {

/// The place among the edges of a part of the one that is nearest to x; of two that which follows `first`
/// sooner.
std::size_t nearest(const Mesh& mesh, const BoundaryPart& part, const Point& x, std::size_t first) {
  std::size_t best = first;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < part.edges.size(); ++i) {
    const std::size_t edge = (first + i) % part.edges.size();
    const auto [a, b] = mesh.edges[part.edges[edge]];
    const Vector along = mesh.points[b] - mesh.points[a], to_x = x - mesh.points[a];
    const double way = std::clamp(to_x.dot(along) / along.squaredNorm(), 0., 1.);
    const double distance = (to_x - way * along).norm();
    if (distance < least) {
      least = distance;
      best = edge;
    }
  }
  return best;
}

bool meet(const std::array<int, 2>& edge, const std::array<int, 2>& other) {
  return std::ranges::find_first_of(edge, other) != edge.end();
}

double size_of(const Mesh& mesh) {
  Point low = mesh.points.front(), high = low;
  for (const Point& point : mesh.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return (high - low).maxCoeff();
}

/// The edge that each row lies on. Where the direction turns a node has two rows, one for each of its edges.
std::vector<int> edges_of(const ContactPart& rows, const Mesh& mesh, const BoundaryPart& part) {
  std::vector<int> edges;
  std::size_t own = 0;
  for (std::size_t row = 0; row < rows.points.size(); ++row) {
    const bool is_second = row > 0 && rows.points[row] == rows.points[row - 1];
    own = nearest(mesh, part, rows.points[row], is_second ? own + 1 : own);
    edges.push_back(part.edges[own]);
  }
  return edges;
}

}  // namespace

std::vector<std::vector<Point>> foundation(const Solution& solution,
                                           const std::map<std::string, Contact>& contacts, double times) {
  const Mesh& mesh = *solution.mesh;
  const double farthest = size_of(mesh) / 4;
  std::vector<std::vector<Point>> lines;
  for (const ContactPart& rows : solution.contact) {
    const auto part = std::ranges::find(mesh.boundary, rows.name, &BoundaryPart::name);
    if (part == mesh.boundary.end()) continue;
    const auto named = contacts.find(rows.name);
    const Contact contact = named == contacts.end() ? Contact{} : named->second;
    const std::vector<int> edges = edges_of(rows, mesh, *part);
    bool goes_on = false;
    for (std::size_t row = 0; row < edges.size(); ++row) {
      const double distance = times * rows.gap[row];
      goes_on = goes_on && meet(mesh.edges[edges[row]], mesh.edges[edges[row - 1]]);
      if (std::abs(distance) <= farthest) {
        if (!goes_on) lines.emplace_back();
        const Vector direction = contact.unit_direction(mesh.outward_normal(edges[row]));
        lines.back().push_back(rows.points[row] + distance * direction);
      }
      goes_on = std::abs(distance) <= farthest;
    }
  }
  return lines;
}

}  // namespace signorini::api
