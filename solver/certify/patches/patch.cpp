#include "certify/patches/patch.hpp"

#include <algorithm>

#include "mesh/bisect.hpp"
#include "mesh/bodies.hpp"
#include "mesh/submesh.hpp"

namespace signorini {
namespace {

constexpr int kPatchLayers = 2;
constexpr int kPatchCuts = 3;
/// Edges on which less than this part of the largest force is moved are left to their surroundings.
constexpr double kHardlyPatch = 0.1;
/// A place where contact ends takes some hundred triangles. A larger patch would take more memory than the
/// solve may have for it (run/memory_estimate.cpp).
constexpr std::size_t kMostInPatch = 1000;

using PointSet = std::vector<bool>;

double force_moved(const Discretization& discrete, const ContactPressure& pressure, int i) {
  const auto& [first, second] = pressure.changes[i];
  return discrete.mesh.length(discrete.clearance.edges[i].edge) * std::max(std::abs(first), std::abs(second));
}

PointSet points_with_changes(const Discretization& discrete, const ContactPressure& pressure, double hardly) {
  const int edges = static_cast<int>(pressure.changes.size());
  double most = 0;
  for (int i = 0; i < edges; ++i) most = std::max(most, force_moved(discrete, pressure, i));
  PointSet points(discrete.mesh.points.size(), false);
  for (int i = 0; i < edges; ++i)
    if (force_moved(discrete, pressure, i) > hardly * most)
      for (const int point : discrete.mesh.edges[discrete.clearance.edges[i].edge]) points[point] = true;
  return points;
}

/// The triangles with a corner in the set, in ascending order.
std::vector<int> triangles_at(const Mesh& mesh, const PointSet& points) {
  std::vector<int> triangles;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (std::ranges::any_of(mesh.triangles[t], [&](int point) { return points[point]; }))
      triangles.push_back(t);
  return triangles;
}

PointSet points_on_contact(const Problem& problem, const Mesh& mesh) {
  PointSet points(mesh.points.size(), false);
  for (const BoundaryPart& part : mesh.boundary) {
    if (!condition_on<Contact>(problem, part.name)) continue;
    for (const int edge : part.edges)
      for (const int point : mesh.edges[edge]) points[point] = true;
  }
  return points;
}

/// The triangles `all` of the whole mesh, those of the core cut.
Patch make_patch(const Discretization& discrete, std::vector<int> all, const std::vector<int>& core) {
  Submesh part(discrete.mesh, all);
  Mesh mesh = with_longest_edges_first(std::move(part.mesh));
  for (int cut = 0; cut < kPatchCuts; ++cut) {
    std::vector<int> marked, parents;
    for (const int t : triangles_at(mesh, points_on_contact(discrete.problem, mesh)))
      if (std::ranges::binary_search(core, all[t])) marked.push_back(t);
    mesh = bisect(mesh, marked, parents);
    for (int& parent : parents) parent = all[parent];
    all = std::move(parents);
  }
  return {std::make_shared<const Mesh>(std::move(mesh)), std::move(all), std::move(part.cut)};
}

std::vector<Patch> patches(const Discretization& discrete, const ContactPressure& pressure, double hardly) {
  const Mesh& whole = discrete.mesh;
  PointSet points = points_with_changes(discrete, pressure, hardly);
  const std::vector<int> core = triangles_at(whole, points);
  if (core.empty()) return {};
  std::vector<int> layers = core;
  for (int layer = 1; layer < kPatchLayers; ++layer) {
    for (const int t : layers)
      for (const int point : whole.triangles[t]) points[point] = true;
    layers = triangles_at(whole, points);
  }
  std::vector<Patch> all;
  for (std::vector<int>& piece : bodies(Submesh(whole, layers).mesh)) {
    for (int& t : piece) t = layers[t];
    std::ranges::sort(piece);
    all.push_back(make_patch(discrete, std::move(piece), core));
  }
  return all;
}

}  // namespace

std::vector<Patch> patches_where_pressure_changes(const Discretization& discrete,
                                                  const ContactPressure& pressure) {
  const auto is_small = [](const Patch& patch) { return patch.parents.size() <= kMostInPatch; };
  for (double hardly = kHardlyPatch; hardly < 1; hardly *= 2)
    if (std::vector<Patch> all = patches(discrete, pressure, hardly); std::ranges::all_of(all, is_small))
      return all;
  return {};
}

}  // namespace signorini
