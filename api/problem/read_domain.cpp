#include <algorithm>
#include <cmath>
#include <limits>

#include "api/limits.hpp"
#include "api/problem/gmsh.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

std::vector<Point> read_points(const Value& value) {
  std::vector<Point> points;
  value.for_each("an array of points, [[x, y], ...]", [&](const Value& element) {
    points.push_back(read_pair(element, "a point, [x, y]", false).value_or(Point::Zero()));
  });
  return points;
}

/// So many point numbers.
template <std::size_t count>
std::array<int, count> read_numbers(const Value& value, std::string_view expected) {
  std::array<int, count> numbers{};
  const auto is_number = [](double number) {
    return number >= 0 && number <= std::numeric_limits<int>::max() && number == std::floor(number);
  };
  if (const auto plain = value.numbers<count>(); plain && std::ranges::all_of(*plain, is_number)) {
    std::ranges::transform(*plain, numbers.begin(), [](double number) { return static_cast<int>(number); });
    return numbers;
  }
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

/// The arc from a vertex to the next one; nothing if it has no centre.
std::optional<Arc> read_arc(const Value& value, int ring, int vertex) {
  const auto object = value.object();
  if (!object) return std::nullopt;
  object->allow({"centre", "long"}, "an arc");
  const auto member = object->require("centre", "the centre of the arc's circle, [x, y]");
  const auto centre = member ? read_pair(*member, "a point, [x, y]", false) : std::nullopt;
  const auto is_long = object->find("long");
  if (is_long && !is_long->json().is_boolean()) is_long->unexpected("true or false");
  if (!centre) return std::nullopt;
  return Arc{ring, vertex, *centre, is_long && is_long->json() == true};
}

/// The vertices of a ring; its arcs go to those of the polygon.
std::vector<Point> read_ring(const Value& value, int ring, Polygon& polygon) {
  std::vector<Point> vertices;
  for (const Value& element : value.list("an array of points, [[x, y], ...]", limits::vertices)) {
    Point at = Point::Zero();
    if (element.json().is_object()) {
      const Object vertex = *element.object();
      vertex.allow({"at", "arc"}, "a vertex");
      if (const auto member = vertex.require("at", "the vertex, [x, y]"))
        at = read_pair(*member, "a point, [x, y]", false).value_or(at);
      if (const auto member = vertex.find("arc"))
        if (const auto arc = read_arc(*member, ring, static_cast<int>(vertices.size())))
          polygon.arcs.push_back(*arc);
    } else {
      at = read_pair(element, R"(a point, [x, y], or {"at": [x, y], "arc": {"centre": [x, y]}})", false)
               .value_or(at);
    }
    vertices.push_back(at);
  }
  return vertices;
}

/// A hole that is a circle: its rightmost point, from which an arc leads back to it.
std::vector<Point> read_circle(const Value& value, int ring, Polygon& polygon) {
  const auto hole = value.object();
  hole->allow({"circle"}, "a hole that is no ring");
  const auto member = hole->require("circle", R"({"centre": [x, y], "radius": r})");
  const auto circle = member ? member->object() : std::nullopt;
  if (!circle) return {Point::Zero()};
  circle->allow({"centre", "radius"}, "a circle");
  const auto centre = circle->require("centre", "its centre, [x, y]");
  const auto radius = circle->require("radius", "its radius, a positive length");
  const auto at = centre ? read_pair(*centre, "a point, [x, y]", false) : std::nullopt;
  const auto length = radius ? radius->positive() : std::nullopt;
  if (!at || !length) return {Point::Zero()};
  polygon.arcs.push_back({ring, 0, *at, false});
  return {Point(at->x() + *length, at->y())};
}

Domain read_polygon(const Object& object) {
  Polygon polygon;
  object.allow({"type", "vertices", "holes", "sides"}, "a polygon");
  if (const auto vertices = object.require("vertices", "the outer ring, [[x, y], ...]"))
    polygon.vertices = read_ring(*vertices, 0, polygon);
  if (const auto holes = object.find("holes"))
    for (const Value& hole :
         holes->list("an array of holes, each a ring of points or a circle", limits::holes)) {
      const int ring = static_cast<int>(polygon.holes.size()) + 1;
      polygon.holes.push_back(hole.json().is_object() ? read_circle(hole, ring, polygon)
                                                      : read_ring(hole, ring, polygon));
    }
  if (const auto sides = object.find("sides"))
    for (const Value& side :
         sides->list("an array of part names, one an edge of the outer ring", limits::vertices))
      polygon.sides.push_back(side.text(limits::part_name).value_or(""));
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
    triangles->for_each("an array of triples of point numbers", [&](const Value& triangle) {
      data.triangles.push_back(read_numbers<3>(triangle, "three point numbers"));
    });
  const auto boundary = object.require("boundary", "the edges of each part, as pairs of point numbers");
  const auto parts = boundary ? boundary->object() : std::nullopt;
  if (!parts) return data;
  if (const std::size_t count = boundary->json().size(); count > limits::parts) {
    boundary->fault("must have at most " + std::to_string(limits::parts) + " parts; it has " +
                    std::to_string(count));
    return data;
  }
  for (const auto& [name, edges] : parts->members()) {
    data.boundary.emplace_back(name, std::vector<std::array<int, 2>>{});
    edges.for_each("an array of pairs of point numbers", [&](const Value& edge) {
      data.boundary.back().second.push_back(read_numbers<2>(edge, "two point numbers"));
    });
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
  if (const auto plain = value.numbers<2>(); plain && (!positive || ((*plain)[0] > 0 && (*plain)[1] > 0)))
    return Eigen::Vector2d((*plain)[0], (*plain)[1]);
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
