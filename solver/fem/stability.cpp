#include "fem/stability.hpp"

#include <algorithm>

#include "fem/rigid_frame.hpp"
#include "fem/small_matrices.hpp"
#include "mesh/bisect.hpp"
#include "mesh/bodies.hpp"

namespace signorini {
namespace {

/// An edge on which displacements are prevented in some directions.
struct Support {
  int edge;
  std::vector<Vector> directions;
  bool is_contact;
};

using Supports = std::vector<Support>;

std::vector<Vector> held_directions(const Condition& condition, const Vector& normal) {
  if (std::holds_alternative<Fixed>(condition)) return {Vector::UnitX(), Vector::UnitY()};
  if (std::holds_alternative<Roller>(condition)) return {normal};
  if (const auto* contact = std::get_if<Contact>(&condition)) return {contact->unit_direction(normal)};
  return {};
}

/// The supports of each body.
std::vector<Supports> supports_of(const Problem& problem, const Mesh& mesh,
                                  const std::vector<std::vector<int>>& bodies) {
  const std::vector<int> body_of = body_of_triangles(mesh, bodies);
  std::vector<Supports> supports(bodies.size());
  for (const BoundaryPart& part : mesh.boundary) {
    const auto condition = problem.boundary.find(part.name);
    if (condition == problem.boundary.end()) continue;
    for (const int edge : part.edges) {
      std::vector<Vector> held = held_directions(condition->second, mesh.outward_normal(edge));
      if (held.empty()) continue;
      supports[body_of[mesh.edge_triangles[edge][0]]].push_back(
          {edge, std::move(held), std::holds_alternative<Contact>(condition->second)});
    }
  }
  return supports;
}

Point middle_of(const Mesh& mesh, int edge) {
  return 0.5 * (mesh.points[mesh.edges[edge][0]] + mesh.points[mesh.edges[edge][1]]);
}

/// A frame of the size of the supports, in the midst of them.
RigidFrame frame_of(const Mesh& mesh, const Supports& supports) {
  Point centre(0, 0);
  for (const Support& support : supports)
    centre += middle_of(mesh, support.edge) / static_cast<double>(supports.size());
  double size = 0;
  for (const Support& support : supports)
    for (const int point : mesh.edges[support.edge])
      size = std::max(size, (mesh.points[point] - centre).norm());
  return {2, centre, size};
}

/// The least part that the means on the edges see of a rigid motion which the supports prevent.
double seen_part(const Mesh& mesh, const Supports& supports) {
  if (supports.empty()) return 1;
  const RigidFrame frame = frame_of(mesh, supports);
  Eigen::Matrix3d prevented = Eigen::Matrix3d::Zero(), seen = prevented;
  for (const auto& [edge, directions, is_contact] : supports) {
    const double length = mesh.length(edge) / frame.size();
    const auto add = [&](Eigen::Matrix3d& form, double weight, const Vector& direction, const Point& x) {
      const Eigen::RowVector3d r = frame.along(direction, x);
      form += weight * length * r.transpose() * r;
    };
    for (const Vector& direction : directions) {
      add(seen, 1, direction, middle_of(mesh, edge));
      // Simpson's rule is exact for squares of linear functions.
      add(prevented, 4. / 6, direction, middle_of(mesh, edge));
      for (const int point : mesh.edges[edge]) add(prevented, 1. / 6, direction, mesh.points[point]);
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
std::vector<int> on_coarse_supports(const Mesh& mesh, const Supports& all) {
  Supports without_contact;
  std::ranges::copy_if(all, std::back_inserter(without_contact),
                       [](const Support& support) { return !support.is_contact; });
  std::vector<int> triangles;
  const auto check = [&](const Supports& supports) {
    if (seen_part(mesh, supports) >= least_part_seen) return;
    for (const Support& support : supports) triangles.push_back(mesh.edge_triangles[support.edge][0]);
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

std::vector<int> to_be_halved(const Problem& problem, const Mesh& mesh) {
  const std::vector<std::vector<int>> all = bodies(mesh);
  const std::vector<Supports> supports = supports_of(problem, mesh, all);
  std::vector<int> triangles;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (problem.scheme == Scheme::nonconforming)
      std::ranges::copy(on_coarse_supports(mesh, supports[i]), std::back_inserter(triangles));
    else if (is_too_small(all[i], supports[i]))
      std::ranges::copy(all[i], std::back_inserter(triangles));
  }
  return triangles;
}

}  // namespace

Mesh stabilized(const Problem& problem, Mesh mesh, Progress* progress) {
  if (components(problem.material) == 1) return mesh;
  const std::vector<int> unstable = to_be_halved(problem, mesh);
  if (unstable.empty()) return mesh;
  Mesh finer = bisect(with_longest_edges_first(mesh), unstable, progress);
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

}  // namespace signorini
