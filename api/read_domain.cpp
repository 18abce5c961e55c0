#include <limits>

#include "api/gmsh.hpp"
#include "api/problem_members.hpp"

namespace signorini::api {
namespace {

constexpr std::size_t longest_part_name = 200;

std::vector<Point> read_points(const Value& value) {
  std::vector<Point> points;
  for (const Value& element : value.list("an array of points, [[x, y], ...]"))
    points.push_back(read_pair(element, "a point, [x, y]", false).value_or(Point::Zero()));
  return points;
}

/// So many point numbers.
template <std::size_t count>
std::array<int, count> read_numbers(const Value& value, std::string_view expected) {
  std::array<int, count> numbers{};
  if (const auto elements = value.elements(count, expected))
    for (std::size_t k = 0; k < count; ++k)
      numbers[k] = (*elements)[k].integer(0, std::numeric_limits<int>::max()).value_or(0);
  return numbers;
}

Domain read_rectangle(const Object& object) {
  Rectangle rectangle;
  object.allow({"type", "origin", "size"}, "a rectangle");
  if (const auto origin = object.find("origin"))
    rectangle.origin =
        read_pair(*origin, "an array of two numbers, [x, y]", false).value_or(rectangle.origin);
  if (const auto size = object.find("size"))
    rectangle.size =
        read_pair(*size, "an array of two positive numbers, [width, height]", true).value_or(rectangle.size);
  return rectangle;
}

Domain read_polygon(const Object& object) {
  Polygon polygon;
  object.allow({"type", "vertices", "holes", "sides"}, "a polygon");
  if (const auto vertices = object.require("vertices", "the outer ring, [[x, y], ...]"))
    polygon.vertices = read_points(*vertices);
  if (const auto holes = object.find("holes"))
    for (const Value& hole : holes->list("an array of rings, each an array of points"))
      polygon.holes.push_back(read_points(hole));
  if (const auto sides = object.find("sides"))
    for (const Value& side : sides->list("an array of part names, one an edge of the outer ring"))
      polygon.sides.push_back(side.text(longest_part_name).value_or(""));
  const bool one_each = polygon.sides.empty() || polygon.sides.size() == polygon.vertices.size();
  if (!one_each)
    object.find("sides")->fault("must name every edge of the outer ring, " +
                                std::to_string(polygon.vertices.size()) + " of them, or be left out");
  return polygon;
}

Domain read_mesh_data(const Object& object) {
  MeshData data;
  object.allow({"type", "points", "triangles", "boundary"}, "a mesh");
  if (const auto points = object.require("points", "the points, [[x, y], ...]"))
    data.points = read_points(*points);
  if (const auto triangles = object.require("triangles", "triples of point numbers, from 0"))
    for (const Value& triangle : triangles->list("an array of triples of point numbers"))
      data.triangles.push_back(read_numbers<3>(triangle, "three point numbers"));
  const auto boundary = object.require("boundary", "the edges of each part, as pairs of point numbers");
  const auto parts = boundary ? boundary->object() : std::nullopt;
  if (!parts) return data;
  for (const auto& [name, edges] : parts->members()) {
    data.boundary.emplace_back(name, std::vector<std::array<int, 2>>{});
    for (const Value& edge : edges.list("an array of pairs of point numbers"))
      data.boundary.back().second.push_back(read_numbers<2>(edge, "two point numbers"));
  }
  return data;
}

Domain read_gmsh(const Object& object) {
  object.allow({"type", "msh"}, "a gmsh domain");
  const auto msh = object.require("msh", "the text of an ASCII .msh file, version 2.2 or 4.1");
  const auto text = msh ? msh->text(std::numeric_limits<std::size_t>::max()) : std::nullopt;
  if (!text) return MeshData{};
  try {
    return parse_gmsh(*text);
  } catch (const InvalidProblem& invalid) {
    msh->faults().add(invalid);
    return MeshData{};
  }
}

}  // namespace

std::optional<Eigen::Vector2d> read_pair(const Value& value, std::string_view expected, bool positive) {
  const auto elements = value.elements(2, expected);
  if (!elements) return std::nullopt;
  const auto read = [&](const Value& element) { return positive ? element.positive() : element.number(); };
  const auto x = read((*elements)[0]), y = read((*elements)[1]);
  if (!x || !y) return std::nullopt;
  return Eigen::Vector2d(*x, *y);
}

Domain read_domain(const Value& value) {
  const auto object = value.object();
  if (!object) return Rectangle{};
  const auto type = object->require("type", "the shape: " + list_of(only_names(domain_names)));
  switch (type ? type->one_of(domain_names).value_or(DomainType::rectangle) : DomainType::rectangle) {
    case DomainType::polygon:
      return read_polygon(*object);
    case DomainType::mesh:
      return read_mesh_data(*object);
    case DomainType::gmsh:
      return read_gmsh(*object);
    default:
      return read_rectangle(*object);
  }
}

}  // namespace signorini::api
