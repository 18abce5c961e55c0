#include "mesh/domain_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "mesh/import.hpp"
#include "mesh/mesh_sizes.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"
#include "mesh/rings.hpp"

namespace signorini {
namespace {

std::vector<Fault> validate(const Adaptive& goal) {
  std::vector<Fault> faults;
  if (!(goal.tolerance > 0 && goal.tolerance < 1))
    faults.push_back({"/mesh/adaptive/tolerance", "must be a number between 0 and 1"});
  if (goal.max_triangles < 1)
    faults.push_back({"/mesh/adaptive/max_triangles", "must be a positive whole number"});
  return faults;
}

std::size_t edges_of_boundary(const MeshData& data) {
  std::size_t count = 0;
  for (const auto& [name, edges] : data.boundary) count += edges.size();
  return count;
}

bool is_large(const MeshData& data) {
  return static_cast<std::int64_t>(data.triangles.size() + edges_of_boundary(data)) > few_triangles;
}

/// What counts alone tell of a mesh that is not looked at.
std::vector<Fault> faults_of_counts(const MeshData& data) {
  const std::size_t corners = 3 * data.triangles.size();
  std::vector<Fault> faults;
  const auto check = [&](std::size_t count, const char* array, const char* what, const char* of_triangles) {
    if (count > corners)
      faults.push_back({data.file.empty() ? array : data.file,
                        "has " + std::to_string(count) + what + ", more than " +
                            std::to_string(data.triangles.size()) + " triangles have " + of_triangles});
  };
  check(data.points.size(), "/domain/points", " points", "corners");
  check(edges_of_boundary(data), "/domain/boundary", " edges of the boundary", "sides");
  return faults;
}

struct Area {
  double operator()(const Rectangle& rectangle) const { return rectangle.size.prod(); }
  double operator()(const Polygon& polygon) const { return area(polygon); }
  double operator()(const MeshData& data) const { return import_mesh(data).area(); }
};

/// What each kind of domain answers, written next to each other.
struct FaultsOfShape {
  std::vector<Fault> operator()(const Rectangle& rectangle) const {
    std::vector<Fault> faults;
    if (!(rectangle.size.minCoeff() > 0) || !rectangle.size.allFinite())
      faults.push_back({"/domain/size", "both sides of a rectangle must be positive lengths"});
    if (!rectangle.origin.allFinite()) faults.push_back({"/domain/origin", "must be finite"});
    // Below this ratio two points of a mesh would round to the same place.
    const bool lost = rectangle.origin.cwiseAbs().maxCoeff() > 1e8 * rectangle.size.minCoeff();
    if (faults.empty() && lost)
      faults.push_back(
          {"/domain",
           "lies so far from the origin that its points cannot be told apart: move the origin closer"});
    return faults;
  }

  std::vector<Fault> operator()(const Polygon& polygon) const { return validate(polygon); }

  std::vector<Fault> operator()(const MeshData& data) const {
    if (is_large(data)) return faults_of_counts(data);
    try {
      import_mesh(data);
    } catch (const InvalidProblem& invalid) {
      return invalid.faults();
    }
    return {};
  }
};

struct FaultsOfRequest {
  const MeshRequest& request;

  std::vector<Fault> operator()(const Rectangle&) const {
    std::vector<Fault> faults;
    if (const auto* squares = std::get_if<Divisions>(&request.fineness)) {
      if (squares->x < 1 || squares->y < 1)
        faults.push_back({"/mesh/divisions", "must be two positive whole numbers"});
    } else if (!(std::get<LargestEdge>(request.fineness).length > 0)) {
      faults.push_back({"/mesh/size", "must be a positive length"});
    }
    if (!request.sizes.empty()) faults.push_back({"/mesh/sizes", "local sizes are for polygons"});
    return faults;
  }

  std::vector<Fault> operator()(const Polygon& polygon) const {
    const auto* edge = std::get_if<LargestEdge>(&request.fineness);
    if (!edge) return {{"/mesh", "a polygon is meshed by size (the largest edge), not by divisions"}};
    return validate(polygon, edge->length, request.sizes);
  }

  std::vector<Fault> operator()(const MeshData&) const { return {}; }
};

struct Make {
  const MeshRequest& request;
  int max_triangles;
  Progress* progress;

  Mesh operator()(const Rectangle& rectangle) const {
    return rectangle_mesh(rectangle, divisions(rectangle, request), request.pattern, progress);
  }
  Mesh operator()(const Polygon& polygon) const {
    return polygon_mesh(polygon, std::get<LargestEdge>(request.fineness).length, request.sizes, max_triangles,
                        progress);
  }
  Mesh operator()(const MeshData& data) const { return import_mesh(data, progress); }
};

}  // namespace

std::vector<std::string> part_names(const Domain& domain) {
  if (std::holds_alternative<Rectangle>(domain)) return rectangle_parts();
  if (const auto* polygon = std::get_if<Polygon>(&domain)) return part_names(*polygon);
  std::vector<std::string> names;
  for (const auto& [name, edges] : std::get<MeshData>(domain).boundary) names.push_back(name);
  return names;
}

bool brings_large_mesh(const Domain& domain) {
  const auto* data = std::get_if<MeshData>(&domain);
  return data && is_large(*data);
}

LargestEdge coarse_edge(const Domain& domain) {
  return {std::sqrt(std::visit(Area{}, domain)) / 4};
}

std::vector<Fault> validate_request(const Domain& domain, const MeshRequest& request) {
  std::vector<Fault> faults = std::visit(FaultsOfRequest{request}, domain);
  if (request.adaptive) std::ranges::copy(validate(*request.adaptive), std::back_inserter(faults));
  return faults;
}

std::vector<Fault> validate(const Domain& domain, const MeshRequest& request) {
  std::vector<Fault> faults = std::visit(FaultsOfShape{}, domain);
  // Without a shape there is no size to compare those of a polygon with.
  if (faults.empty() || !std::holds_alternative<Polygon>(domain))
    std::ranges::copy(validate_request(domain, request), std::back_inserter(faults));
  return faults;
}

Mesh make_domain_mesh(const Domain& domain, const MeshRequest& request, Progress* progress) {
  Mesh mesh = std::visit(Make{request, most_triangles, progress}, domain);
  return request.refine > 0 ? refine(mesh, request.refine, most_triangles, progress) : mesh;
}

std::optional<Mesh> make_small_mesh(const Domain& domain, const MeshRequest& request, std::int64_t most) {
  // Two triangles are predicted for an edge of a polygon, and one at least for a chord between arcs that
  // nearly touch; of so many edges nothing else need be looked at.
  if (const auto* polygon = std::get_if<Polygon>(&domain)) {
    const auto enough = static_cast<std::size_t>(most);
    if (2 * Rings(*polygon).points.size() > enough) return std::nullopt;
    constexpr double any_chord = std::numeric_limits<double>::infinity();
    if (followed_rings(*polygon, any_chord, enough).points.size() > enough) return std::nullopt;
  }
  if (PredictedSizes(domain)(request).triangles > most) return std::nullopt;
  if (const auto* data = std::get_if<MeshData>(&domain)) return import_sound_mesh(*data);
  try {
    return std::visit(Make{request, static_cast<int>(4 * most), nullptr}, domain);
  } catch (const TooManyTriangles&) {
    return std::nullopt;
  }
}

std::optional<Mesh> make_coarse_mesh(const Domain& domain) {
  if (std::holds_alternative<Rectangle>(domain))
    return make_small_mesh(domain, {Divisions{4, 4}, Pattern::crossed});
  if (std::holds_alternative<Polygon>(domain))
    return make_small_mesh(domain, MeshRequest(coarse_edge(domain)));
  return brings_large_mesh(domain) ? std::nullopt : make_small_mesh(domain, {});
}

}  // namespace signorini
