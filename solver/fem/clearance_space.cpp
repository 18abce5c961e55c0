#include "fem/clearance_space.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "fem/contact_direction.hpp"
#include "fem/edge_pieces.hpp"
#include "fem/lagrange.hpp"
#include "mesh/parts.hpp"

namespace signorini {
namespace {

/// What the other parts say of the normal displacement at their points, where a contact part begins or ends.
struct HeldPoints {
  std::unordered_map<int, Vector> fixed;  ///< u on Γ_D; for a membrane in the first component
  struct Rolling {
    int edge;
    Vector moved;
  };
  std::unordered_multimap<int, Rolling> rollers;

  HeldPoints(const Problem& problem, const Mesh& mesh) {
    for (const BoundaryPart& part : mesh.boundary) {
      if (const auto* condition = condition_on<Fixed>(problem, part.name)) add_fixed(*condition, part, mesh);
      if (const auto* roller = condition_on<Roller>(problem, part.name))
        add_roller(part, roller->motion, mesh);
    }
  }

 private:
  void add_fixed(const Fixed& condition, const BoundaryPart& part, const Mesh& mesh) {
    for (const int edge : part.edges)
      for (int end = 0; end < 2; ++end) {
        const auto [x, normal] = mesh.on_boundary(edge, end);
        Vector u(condition.value(0, x, normal), 0);
        if (condition.value.size() == 2) u.y() = condition.value(1, x, normal);
        fixed.try_emplace(mesh.edges[edge][end], u);
      }
  }

  void add_roller(const BoundaryPart& part, const SupportMotion& motion, const Mesh& mesh) {
    for (const int edge : part.edges)
      for (const int point : mesh.edges[edge])
        rollers.emplace(point, Rolling{edge, motion(mesh.points[point])});
  }
};

class Builder {
 public:
  Builder(const Problem& problem, const Mesh& mesh, double reach, ClearanceOf of)
      : mesh_(mesh),
        reach_(reach),
        of_(of),
        components_(components(problem.material)),
        order_(spaces_of(problem.scheme, components_).order),
        held_(problem, mesh) {
    space_.reach = reach;
    for (const auto& [point, u] : held_.fixed) largest_fixed_ = std::max(largest_fixed_, u.norm());
  }

  void add_part(int part, const Contact& contact) {
    rows_of_node_.clear();
    directions_at_node_.clear();
    const BoundaryPart& boundary = mesh_.boundary[part];
    const std::vector<std::array<int, 2>> ways = directed_edges(mesh_, boundary);
    for (std::size_t i = 0; i < ways.size(); ++i) add_edge(part, boundary.edges[i], ways[i], contact);
  }

  ClearanceSpace take() { return std::move(space_); }

 private:
  /// What rounds the coordinates of short edges does not turn the direction where the part runs on straight.
  Vector straightened(Vector direction, int edge, const std::array<int, 2>& way) {
    const double rounding = mesh_.rounding_of_normal(edge);
    for (const int node : way) {
      const auto [begin, end] = directions_at_node_.equal_range(node);
      for (auto known = begin; known != end; ++known)
        if (is_same_direction(known->second.direction, direction, known->second.rounding + rounding))
          direction = known->second.direction;
    }
    for (const int node : way) directions_at_node_.emplace(node, DirectionAtNode{direction, rounding});
    return direction;
  }

  /// `way`: the ends of the edge in the direction in which the part runs.
  void add_edge(int part, int edge, const std::array<int, 2>& way, const Contact& condition) {
    const auto [a, b] = mesh_.edges[edge];
    const Point from = mesh_.points[a], to = mesh_.points[b];
    const auto true_gap = [&](double s) {
      const auto [x, normal] = mesh_.on_boundary(edge, s);
      return condition.gap(x, normal);
    };
    const auto gap = [&](double s) { return std::min(true_gap(s), reach_); };
    const LocalVector projection = project_onto_edge(order_, edge_moments(order_, gap));
    const Vector direction = contact_direction(mesh_, mesh_.boundary[part], condition, edge);
    ContactEdge contact{edge, {}, {}, straightened(direction, edge, way)};
    for (int end = 0; end < 2 && of_ == ClearanceOf::solution; ++end)
      require_room(part, edge, end, condition, contact.direction);
    if (order_ == 0)
      contact.rows[0] = contact.rows[1] = new_row({part, (from + to) / 2, projection[0]});
    else
      for (const int node : way)
        contact.rows[node == a ? 0 : 1] =
            row_of_node(part, edge, node, gap(node == a ? 0 : 1), contact.direction);
    for (int j = 0; j <= order_; ++j)
      space_.rows[contact.rows[j]].beyond = std::max(0., true_gap(order_ == 0 ? 0.5 : j) - reach_);
    for (int j = 0; j <= order_; ++j) {
      contact.gap[j] = projection[j];
      space_.rows[contact.rows[j]].weight += mesh_.length(edge) / (order_ + 1);
    }
    space_.edges.push_back(contact);
  }

  int new_row(ClearanceRow row) {
    row.unknown = space_.unknowns++;
    space_.rows.push_back(row);
    return static_cast<int>(space_.rows.size()) - 1;
  }

  /// Where the direction turns, u_n jumps though u does not, and so does the clearance.
  int row_of_node(int part, int edge, int node, double gap, const Vector& direction) {
    const auto [begin, end] = rows_of_node_.equal_range(node);
    for (auto known = begin; known != end; ++known)
      if (components_ == 1 || known->second.direction == direction) return known->second.row;
    const ClearanceRow row{part, mesh_.points[node], gap};
    const auto held = held_displacement(node, edge, direction);
    const int index = held ? held_row(row, *held) : new_row(row);
    rows_of_node_.emplace(node, RowOfNode{index, direction});
    return index;
  }

  /// u_n at a node that another part holds: on Γ_D, or between rollers that run on in the same direction.
  std::optional<double> held_displacement(int node, int edge, const Vector& direction) const {
    const auto fixed = held_.fixed.find(node);
    if (fixed != held_.fixed.end())
      return components_ == 1 ? -fixed->second.x() : fixed->second.dot(direction);
    const auto [begin, end] = held_.rollers.equal_range(node);
    for (auto own = begin; own != end; ++own) {
      const auto& [roller, moved] = own->second;
      if (is_same_direction(mesh_.outward_normal(roller), direction,
                            mesh_.rounding_of_normal(roller) + mesh_.rounding_of_normal(edge)))
        return moved.dot(direction);
    }
    return std::nullopt;
  }

  double rounding_of(double gap) const { return 1e-12 * (std::abs(gap) + largest_fixed_); }

  void require_room(int part, int edge, int end, const Contact& condition, const Vector& direction) const {
    const int node = mesh_.edges[edge][end];
    const auto held = held_displacement(node, edge, direction);
    if (!held) return;
    const double gap = values_at_end(condition.gap, EdgeLine(mesh_, edge), end, rounding_of(*held)).upper();
    if (!(gap < *held - rounding_of(gap))) return;
    const bool is_fixed = held_.fixed.contains(node);
    throw InvalidProblem(
        {{"/boundary/" + mesh_.boundary[part].name + "/gap",
          "the contact can never be met at " + to_string(mesh_.points[node]) + ", where a " +
              (is_fixed ? "fixed part" : "roller") +
              " beside it holds the body beyond the gap, and no displacement jumps: raise the gap "
              "there" +
              (is_fixed ? " or the fixed value" : "")}});
  }

  /// λ = g − u_n is known there; where the gap jumps in the node it may seem to be negative.
  int held_row(ClearanceRow row, double normal_displacement) {
    row.datum = row.gap - normal_displacement;
    if (of_ == ClearanceOf::solution && row.datum < rounding_of(row.gap)) row.datum = 0;
    space_.rows.push_back(row);
    return static_cast<int>(space_.rows.size()) - 1;
  }

  const Mesh& mesh_;
  const double reach_;
  const ClearanceOf of_;
  const int components_;
  const int order_;
  const HeldPoints held_;
  double largest_fixed_ = 0;
  struct RowOfNode {
    int row;
    Vector direction;
  };
  struct DirectionAtNode {
    Vector direction;
    double rounding;
  };
  std::unordered_multimap<int, RowOfNode> rows_of_node_;              ///< of the part that is being added
  std::unordered_multimap<int, DirectionAtNode> directions_at_node_;  ///< likewise
  ClearanceSpace space_;
};

}  // namespace

Eigen::VectorXd ClearanceSpace::clearance(const Eigen::VectorXd& unknown) const {
  Eigen::VectorXd all(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    all[i] = rows[i].unknown < 0 ? rows[i].datum : unknown[rows[i].unknown];
  return all;
}

bool ClearanceSpace::is_touched_too_early(const Eigen::VectorXd& unknown) const {
  return std::ranges::any_of(rows, [&](const ClearanceRow& row) {
    return row.unknown >= 0 && row.beyond > 0 && unknown[row.unknown] <= 0;
  });
}

ClearanceSpace make_clearance_space(const Problem& problem, const Mesh& mesh, double reach, ClearanceOf of) {
  Builder builder(problem, mesh, reach, of);
  for (int part = 0; part < static_cast<int>(mesh.boundary.size()); ++part)
    if (const auto* contact = condition_on<Contact>(problem, mesh.boundary[part].name))
      builder.add_part(part, *contact);
  return builder.take();
}

}  // namespace signorini
