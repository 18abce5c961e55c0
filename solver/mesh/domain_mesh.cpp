#include "mesh/domain_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mesh/import.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"

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

struct Area {
  double operator()(const Rectangle& rectangle) const { return rectangle.size.prod(); }
  double operator()(const Polygon& polygon) const { return area(polygon); }
  double operator()(const MeshData& data) const { return import_mesh(data).area(); }
};

/// What each kind of domain answers, written next to each other.
struct Faults {
  const MeshRequest& request;

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
    if (auto faults = validate(polygon); !faults.empty()) return faults;
    const auto* edge = std::get_if<LargestEdge>(&request.fineness);
    if (!edge) return {{"/mesh", "a polygon is meshed by size (the largest edge), not by divisions"}};
    return validate(polygon, edge->length, request.sizes);
  }

  std::vector<Fault> operator()(const MeshData& data) const {
    try {
      import_mesh(data);
    } catch (const InvalidProblem& invalid) {
      return invalid.faults();
    }
    return {};
  }
};

struct Make {
  const MeshRequest& request;

  Mesh operator()(const Rectangle& rectangle) const {
    return rectangle_mesh(rectangle, divisions(rectangle, request), request.pattern);
  }
  Mesh operator()(const Polygon& polygon) const {
    return polygon_mesh(polygon, std::get<LargestEdge>(request.fineness).length, request.sizes);
  }
  Mesh operator()(const MeshData& data) const { return import_mesh(data); }
};

struct MakeCoarse {
  Mesh operator()(const Rectangle& rectangle) const {
    return rectangle_mesh(rectangle, {4, 4}, Pattern::crossed);
  }
  Mesh operator()(const Polygon& polygon) const {
    return polygon_mesh(polygon, coarse_edge(polygon).length);
  }
  Mesh operator()(const MeshData& data) const { return import_mesh(data); }
};

}  // namespace

std::vector<std::string> part_names(const Domain& domain) {
  if (std::holds_alternative<Rectangle>(domain)) return rectangle_parts();
  if (const auto* polygon = std::get_if<Polygon>(&domain)) return part_names(*polygon);
  std::vector<std::string> names;
  for (const auto& [name, edges] : std::get<MeshData>(domain).boundary) names.push_back(name);
  return names;
}

LargestEdge coarse_edge(const Domain& domain) {
  return {std::sqrt(std::visit(Area{}, domain)) / 4};
}

std::vector<Fault> validate(const Domain& domain, const MeshRequest& request) {
  std::vector<Fault> faults = std::visit(Faults{request}, domain);
  if (request.adaptive) std::ranges::copy(validate(*request.adaptive), std::back_inserter(faults));
  return faults;
}

Mesh make_domain_mesh(const Domain& domain, const MeshRequest& request) {
  Mesh mesh = std::visit(Make{request}, domain);
  return request.refine > 0 ? refine(mesh, request.refine) : mesh;
}

Mesh make_coarse_mesh(const Domain& domain) {
  return std::visit(MakeCoarse{}, domain);
}

}  // namespace signorini
