#include "api/result/boundary_lines.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "mesh/parts.hpp"

namespace signorini::api {
namespace {

/// The rows of a contact part by the edges of its mesh, in the order in which ContactPart has them: an edge
/// after the other along the part, and of P1 a node after the other, again where the direction of the contact
/// turns.
class ContactRows {
 public:
  ContactRows(const Mesh& mesh, Scheme scheme, const ContactPart& part)
      : mesh_(mesh), is_by_nodes_(scheme == Scheme::conforming), part_(part) {}

  /// Those at the ends of the next edge, which runs this way.
  std::array<std::size_t, 2> next(const std::array<int, 2>& way) {
    if (!is_by_nodes_) return {next_, next_++};
    const std::size_t begin = row_at(way[0], true);
    return {begin, row_at(way[1], false)};
  }

 private:
  /// A new one if the next row is this node's; else the one that an edge before this has made.
  std::size_t row_at(int node, bool latest) {
    std::vector<std::size_t>& known = rows_of_node_[node];
    const bool is_new = next_ < part_.points.size() && part_.points[next_] == mesh_.points[node];
    if (is_new || known.empty()) known.push_back(next_++);
    return is_new || latest ? known.back() : known.front();
  }

  const Mesh& mesh_;
  const bool is_by_nodes_;
  const ContactPart& part_;
  std::size_t next_ = 0;
  std::map<int, std::vector<std::size_t>> rows_of_node_;
};

BoundaryLine line_of(const Mesh& mesh, int part, int edge) {
  BoundaryLine line;
  line.part = part;
  const auto& [one, other] = mesh.edge_triangles[edge];
  line.triangle = std::max(one, other);
  const int opposite = mesh.local_edge(line.triangle, edge);
  line.corners = {(opposite + 1) % 3, (opposite + 2) % 3};
  line.clearance = line.pressure = {std::nan(""), std::nan("")};
  return line;
}

double value_at(const std::vector<double>& values, std::size_t row) {
  return row < values.size() ? values[row] : std::nan("");
}

}  // namespace

std::vector<BoundaryLine> boundary_lines(const Solution& solution) {
  const Mesh& mesh = *solution.mesh;
  std::vector<BoundaryLine> lines;
  for (std::size_t number = 0; number < mesh.boundary.size(); ++number) {
    const BoundaryPart& part = mesh.boundary[number];
    const auto contact = std::ranges::find(solution.contact, part.name, &ContactPart::name);
    std::optional<ContactRows> rows;
    if (contact != solution.contact.end()) rows.emplace(mesh, solution.scheme, *contact);
    const std::vector<std::array<int, 2>> ways = directed_edges(mesh, part);
    for (std::size_t i = 0; i < ways.size(); ++i) {
      BoundaryLine line = line_of(mesh, static_cast<int>(number), part.edges[i]);
      if (rows) {
        const std::array<std::size_t, 2> ends = rows->next(ways[i]);
        for (int end = 0; end < 2; ++end) {
          const bool is_begin = mesh.triangles[line.triangle][line.corners[end]] == ways[i][0];
          const std::size_t row = ends[is_begin ? 0 : 1];
          line.clearance[end] = value_at(contact->clearance, row);
          line.pressure[end] = value_at(contact->pressure, row);
        }
      }
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace signorini::api
