#include "fem/stability.hpp"

#include <algorithm>

#include "fem/rigid_frame.hpp"
#include "fem/small_matrices.hpp"
#include "mesh/bisect.hpp"
#include "mesh/bodies.hpp"
#include "mesh/edge_table.hpp"
#include "mesh/segments.hpp"

namespace signorini {
namespace {

/// An edge on which displacements are prevented in some directions.
struct Support {
  Segment ends;
  int triangle;  ///< that has it
  std::vector<Vector> directions;
  bool is_contact;

  Point middle() const { return 0.5 * (ends[0] + ends[1]); }
};

using Supports = std::vector<Support>;

std::vector<Vector> held_directions(const Condition& condition, const Segment& ends) {
  if (std::holds_alternative<Fixed>(condition)) return {Vector::UnitX(), Vector::UnitY()};
  const Vector way = (ends[1] - ends[0]).normalized(), normal(way.y(), -way.x());
  if (std::holds_alternative<Roller>(condition)) return {normal};
  if (const auto* contact = std::get_if<Contact>(&condition)) return {contact->unit_direction(normal)};
  return {};
}

/// The triangles of each body, and its supports.
struct Bodies {
  std::vector<std::vector<int>> triangles;
  std::vector<Supports> supports;

  Bodies(std::vector<std::vector<int>> all, std::size_t count)
      : triangles(std::move(all)),
        supports(triangles.size()),
        body_of_(body_of_triangles(triangles, count)) {}

  void add(const Condition& condition, const Segment& ends, int triangle) {
    std::vector<Vector> held = held_directions(condition, ends);
    if (!held.empty())
      supports[body_of_[triangle]].push_back(
          {ends, triangle, std::move(held), std::holds_alternative<Contact>(condition)});
  }

 private:
  std::vector<int> body_of_;
};

/// A frame of the size of the supports, in the midst of them.
RigidFrame frame_of(const Supports& supports) {
  Point centre(0, 0);
  for (const Support& support : supports) centre += support.middle() / static_cast<double>(supports.size());
  double size = 0;
  for (const Support& support : supports)
    for (const Point& end : support.ends) size = std::max(size, (end - centre).norm());
  return {2, centre, size};
}

/// The least part that the means on the edges see of a rigid motion which the supports prevent.
double seen_part(const Supports& supports) {
  if (supports.empty()) return 1;
  const RigidFrame frame = frame_of(supports);
  Eigen::Matrix3d prevented = Eigen::Matrix3d::Zero(), seen = prevented;
  for (const Support& support : supports) {
    const double length = (support.ends[1] - support.ends[0]).norm() / frame.size();
    const auto add = [&](Eigen::Matrix3d& form, double weight, const Vector& direction, const Point& x) {
      const Eigen::RowVector3d r = frame.along(direction, x);
      form += weight * length * r.transpose() * r;
    };
    for (const Vector& direction : support.directions) {
      add(seen, 1, direction, support.middle());
      // Simpson's rule is exact for squares of linear functions.
      add(prevented, 4. / 6, direction, support.middle());
      for (const Point& end : support.ends) add(prevented, 1. / 6, direction, end);
    }
  }
  const Spectrum spectrum(prevented);
  const Eigen::Vector3d values = spectrum.values;
  Eigen::Matrix3d scaled = spectrum.vectors;
  int free = 0;
  for (; values[free] < 1e-12 * values[2]; ++free) scaled.col(free).setZero();
  for (int i = free; i < 3; ++i) scaled.col(i) /= std::sqrt(values[i]);
  const Eigen::Matrix3d part = scaled.transpose() * seen * scaled;
  return eigenvalues(part)[free];
}

constexpr double least_part_seen = 0.25;

/// The triangles on supports whose middles alone do not hold the body.
std::vector<int> on_coarse_supports(const Supports& all) {
  Supports without_contact;
  std::ranges::copy_if(all, std::back_inserter(without_contact),
                       [](const Support& support) { return !support.is_contact; });
  std::vector<int> triangles;
  const auto check = [&](const Supports& supports) {
    if (seen_part(supports) >= least_part_seen) return;
    for (const Support& support : supports) triangles.push_back(support.triangle);
  };
  check(without_contact);
  check(all);
  return triangles;
}

/// Whether one or two triangles leave a rotation free that is not rigid.
bool is_too_small(const std::vector<int>& body, const Supports& supports) {
  std::size_t held = 0;
  for (const Support& support : supports)
    if (!support.is_contact) held += support.directions.size();
  return (body.size() == 1 && held < 3) || (body.size() == 2 && held < 2);
}

std::vector<int> to_be_halved(Scheme scheme, const Bodies& bodies) {
  std::vector<int> triangles;
  for (std::size_t i = 0; i < bodies.triangles.size(); ++i) {
    if (scheme == Scheme::nonconforming)
      std::ranges::copy(on_coarse_supports(bodies.supports[i]), std::back_inserter(triangles));
    else if (is_too_small(bodies.triangles[i], bodies.supports[i]))
      std::ranges::copy(bodies.triangles[i], std::back_inserter(triangles));
  }
  return triangles;
}

Bodies bodies_of(const Problem& problem, const Mesh& mesh) {
  Bodies all(bodies(mesh), mesh.triangles.size());
  for (const BoundaryPart& part : mesh.boundary) {
    const auto condition = problem.boundary.find(part.name);
    if (condition == problem.boundary.end()) continue;
    for (const int edge : part.edges) {
      const auto [a, b] = mesh.edges[edge];
      all.add(condition->second, {mesh.points[a], mesh.points[b]}, mesh.edge_triangles[edge][0]);
    }
  }
  return all;
}

}  // namespace

Mesh stabilized(const Problem& problem, Mesh mesh, Progress* progress) {
  if (components(problem.material) == 1) return mesh;
  const std::vector<int> unstable = to_be_halved(problem.scheme, bodies_of(problem, mesh));
  if (unstable.empty()) return mesh;
  Mesh finer = with_lowest_corners_first(bisect(with_longest_edges_first(mesh), unstable, progress));
  finer.notes = std::move(mesh.notes);
  finer.notes.push_back(
      "the spaces for elasticity are not stable on the " + std::to_string(mesh.triangles.size()) +
      " triangles asked for, " +
      (problem.scheme == Scheme::nonconforming
           ? "as too few edges support the body to keep it from turning: those on its supports "
           : "as some are a body of too few: those ") +
      "were halved, which makes " + std::to_string(finer.triangles.size()) + " triangles");
  return finer;
}

MeshSizes stabilized(const Problem& problem, const MeshData& data, MeshSizes sizes) {
  if (components(problem.material) == 1) return sizes;
  const EdgeTable edges(data.triangles);
  Bodies all(bodies(data.triangles, edges), data.triangles.size());
  const auto for_each_side = [&](const auto& visit) {
    for (std::size_t part = 0; part < data.boundary.size(); ++part)
      for (const auto& [a, b] : data.boundary[part].second)
        if (const auto sides = edges.between({a, b}); !sides.empty())
          visit(part, Segment{data.points[a], data.points[b]}, sides[0].triangle);
  };
  for_each_side([&](std::size_t part, const Segment& ends, int triangle) {
    const auto condition = problem.boundary.find(data.boundary[part].first);
    if (condition != problem.boundary.end()) all.add(condition->second, ends, triangle);
  });
  std::vector<bool> is_halved(data.triangles.size(), false);
  for (const int t : to_be_halved(problem.scheme, all)) is_halved[t] = true;
  // A triangle is made four, and a neighbour two by the edge that they share.
  edges.for_each_edge([&](const auto& sides) {
    const auto halved =
        std::ranges::count_if(sides, [&](const auto& side) { return is_halved[side.triangle]; });
    if (halved > 0) ++sizes.points, sizes.triangles += static_cast<std::int64_t>(sides.size());
  });
  for_each_side([&](std::size_t part, const Segment&, int triangle) {
    if (is_halved[triangle]) ++sizes.parts[part].edges;
  });
  sizes.edges = (3 * sizes.triangles + sizes.edges_of_parts()) / 2;
  return sizes;
}

}  // namespace signorini
