#include <cmath>
#include <cstdint>

#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/rectangle.hpp"

namespace signorini::api {
namespace {

std::optional<Divisions> read_divisions(const Value& value) {
  const auto elements = value.elements(2, "an array of two whole numbers, [nx, ny]");
  if (!elements) return std::nullopt;
  const auto x = (*elements)[0].integer(1, limits::divisions),
             y = (*elements)[1].integer(1, limits::divisions);
  if (!x || !y) return std::nullopt;
  return Divisions{*x, *y};
}

/// Whether the mesh would have so many triangles that no machine of our time solves it.
bool is_absurd(const MeshRequest& mesh, const Rectangle& domain) {
  // First in floating point: the number of squares of a tiny size would overflow.
  if (const auto* edge = std::get_if<LargestEdge>(&mesh.fineness))
    if (domain.size.maxCoeff() / edge->length > static_cast<double>(limits::triangles)) return true;
  const Divisions squares = divisions(domain, mesh);
  const std::int64_t triangles_per_square = mesh.pattern == Pattern::crossed ? 4 : 2;
  const std::int64_t refined = std::int64_t{1} << (2 * mesh.refine);
  return std::int64_t{squares.x} * squares.y * triangles_per_square > limits::triangles / refined;
}

std::string limit() {
  return "asks for more than " + std::to_string(limits::triangles) + " triangles; ";
}

void read_size(const Value& value, const Rectangle& domain, MeshRequest& mesh) {
  const auto length = value.positive();
  if (!length) return;
  mesh.fineness = LargestEdge{*length};
  if (is_absurd(mesh, domain)) {
    // In both ways of cutting squares, edges of length h make about 4 area / h² triangles.
    const double side = std::sqrt(domain.size.x()) * std::sqrt(domain.size.y());
    const double sensible = side * 2 / std::sqrt(static_cast<double>(limits::triangles));
    value.fault(limit() + "give a size above " + shortest(sensible));
  }
}

void read_squares(const Value& value, const Rectangle& domain, MeshRequest& mesh) {
  const auto squares = read_divisions(value);
  if (!squares) return;
  mesh.fineness = *squares;
  if (is_absurd(mesh, domain)) value.fault(limit() + "give fewer divisions or refinements");
}

void read_refine(const Object& object, MeshRequest& mesh) {
  if (const auto times = object.find("refine"))
    mesh.refine = times->integer(0, limits::refinements).value_or(0);
}

void read_adaptive(const Object& object, MeshRequest& mesh) {
  const auto value = object.find("adaptive");
  if (!value) return;
  mesh.adaptive = Adaptive{};
  const auto goal = value->object();
  if (!goal) return;
  goal->allow({"tolerance", "max_triangles", "quantity"}, "a mesh that refines itself");
  if (const auto quantity = goal->find("quantity"))
    mesh.adaptive->quantity = quantity->text(limits::part_name).value_or("");
  if (const auto tolerance = goal->require("tolerance", "the relative error bound to reach"))
    mesh.adaptive->tolerance =
        tolerance->number("a number between 0 and 1", [](double t) { return t > 0 && t < 1; }).value_or(0.5);
  if (const auto most = goal->find("max_triangles"))
    mesh.adaptive->max_triangles = most->integer(1, limits::triangles).value_or(mesh.adaptive->max_triangles);
}

MeshRequest read_rectangle_mesh(const Value& value, const Object& object, const Rectangle& domain) {
  MeshRequest mesh;
  object.allow({"size", "divisions", "pattern", "refine", "adaptive"}, "the mesh of a rectangle");
  read_refine(object, mesh);
  read_adaptive(object, mesh);
  if (const auto pattern = object.find("pattern"))
    mesh.pattern = pattern->one_of(pattern_names).value_or(mesh.pattern);
  const auto size = object.find("size"), divisions = object.find("divisions");
  const bool may_start_anywhere = mesh.adaptive && !size && !divisions;
  if (may_start_anywhere) mesh.fineness = coarse_edge(domain);
  if (!may_start_anywhere && size.has_value() == divisions.has_value())
    value.fault("must have either size (the largest edge length) or divisions ([nx, ny])");
  if (size) read_size(*size, domain, mesh);
  if (divisions) read_squares(*divisions, domain, mesh);
  return mesh;
}

LocalSize read_local_size(const Value& value) {
  LocalSize local;
  const auto object = value.object();
  if (!object) return local;
  object->allow({"at", "radius", "size"}, "a local size");
  if (const auto at = object->require("at", "the centre, [x, y]"))
    local.at = read_pair(*at, "a point, [x, y]", false).value_or(local.at);
  if (const auto radius = object->require("radius", "the radius of the disc"))
    local.radius = radius->number("a number, at least 0", [](double r) { return r >= 0; }).value_or(0);
  if (const auto size = object->require("size", "the largest edge length in the disc"))
    local.size = size->positive().value_or(1);
  return local;
}

MeshRequest read_polygon_mesh(const Object& object, const Polygon& domain) {
  MeshRequest mesh;
  object.allow({"size", "sizes", "refine", "adaptive"}, "the mesh of a polygon");
  read_refine(object, mesh);
  read_adaptive(object, mesh);
  mesh.fineness = mesh.adaptive ? coarse_edge(domain) : LargestEdge{1};
  if (const auto size =
          mesh.adaptive ? object.find("size") : object.require("size", "the largest edge length"))
    mesh.fineness = LargestEdge{size->positive().value_or(1)};
  if (const auto sizes = object.find("sizes")) {
    for (const Value& local : sizes->list("an array of local sizes, {at, radius, size}", limits::local_sizes))
      mesh.sizes.push_back(read_local_size(local));
    if (mesh.sizes.size() * domain.vertex_count() > limits::mesh_local_sizes)
      sizes->fault("has " + std::to_string(mesh.sizes.size()) + " local sizes beside " +
                   std::to_string(domain.vertex_count()) +
                   " sides of the polygon; multiplied, these may be " +
                   std::to_string(limits::mesh_local_sizes) + ": take fewer of one of them");
  }
  return mesh;
}

MeshRequest read_given_mesh(const Object& object) {
  MeshRequest mesh;
  object.allow({"refine", "adaptive"}, "the mesh of a domain that brings its own");
  read_refine(object, mesh);
  read_adaptive(object, mesh);
  return mesh;
}

}  // namespace

MeshRequest read_mesh(const Value& value, const Domain& domain) {
  const auto object = value.object();
  if (!object) return {};
  if (const auto* rectangle = std::get_if<Rectangle>(&domain))
    return read_rectangle_mesh(value, *object, *rectangle);
  const auto* polygon = std::get_if<Polygon>(&domain);
  return polygon ? read_polygon_mesh(*object, *polygon) : read_given_mesh(*object);
}

}  // namespace signorini::api
