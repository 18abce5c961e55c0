// Meshes of polygons: what was asked for is kept, whatever the units; and every fault of a polygon.
#include "mesh/polygon.hpp"
#include <algorithm>

#include <gtest/gtest.h>

#include "mesh_quality.hpp"

namespace signorini::polygon_test {
namespace {

const std::vector<Point> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
const std::vector<Point> l_shape{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

std::vector<Point> box(double x, double y, double size) {
  return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

std::vector<Point> regular(Point centre, double radius, int corners, double from, double to) {
  std::vector<Point> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = from + (to - from) * i / (corners - 1);
    points.push_back(centre + radius * Vector(std::cos(angle), std::sin(angle)));
  }
  return points;
}

Polygon half_disc() {
  Polygon polygon{regular({0, 1}, 1, 400, std::numbers::pi, 2 * std::numbers::pi), {}, {}};
  polygon.sides.assign(400, "arc");
  polygon.sides.back() = "top";
  return polygon;
}

Polygon with_two_holes() {
  return {box(0, 0, 4), {box(1, 1, 0.5), {{3, 2}, {2, 3}, {3, 3}}}, {"a", "b", "a", "c"}};
}

Polygon scaled(Polygon polygon, double factor) {
  for (Point& x : polygon.vertices) x *= factor;
  for (auto& hole : polygon.holes)
    for (Point& x : hole) x *= factor;
  return polygon;
}

/// The pointers of all faults, and their details.
std::string faults_of(const Polygon& polygon) {
  std::string text;
  for (const Fault& fault : validate(polygon)) text += fault.where + " " + fault.detail + "\n";
  return text;
}

void expect_sound(const Mesh& mesh, const Polygon& polygon, double size) {
  EXPECT_NEAR(mesh.area(), area(polygon), 1e-11 * area(polygon));
  EXPECT_LE(longest_edge(mesh), size * (1 + 1e-8));
  EXPECT_EQ(misfiled_edges(mesh), 0);
  EXPECT_EQ(names_of(mesh), part_names(polygon));
  for (std::size_t i = 0; i < polygon.vertices.size(); ++i) EXPECT_EQ(mesh.points[i], polygon.vertices[i]);
}

TEST(PolygonMesh, OfAnLShapeHasItsAreaItsSizeAndGoodAngles) {
  const Polygon polygon{l_shape, {}, {}};
  const Mesh mesh = polygon_mesh(polygon, 0.1);
  expect_sound(mesh, polygon, 0.1);
  EXPECT_GT(smallest_angle(mesh), 20.7);
  EXPECT_LT(mesh.triangles.size(), 3000u);
}

TEST(PolygonMesh, KeepsEverySideWithItsName) {
  const Polygon polygon{l_shape, {}, {"floor", "", "", "", "", "wall"}};
  Polygon named = polygon;
  for (int i = 1; i < 5; ++i) named.sides[i] = "s" + std::to_string(i);
  for (const bool clockwise : {false, true}) {
    if (clockwise) {
      std::ranges::reverse(named.vertices);
      // Edge i now joins what were the vertices n−1−i and n−2−i.
      std::rotate(named.sides.begin(), named.sides.end() - 1, named.sides.end());
      std::ranges::reverse(named.sides);
    }
    const Mesh mesh = polygon_mesh(named, 0.3);
    expect_sound(mesh, named, 0.3);
    for (const int e : part_of(mesh, "floor").edges)
      EXPECT_LT((mesh.outward_normal(e) - Vector(0, -1)).norm(), 1e-15);
    for (const int e : part_of(mesh, "wall").edges)
      EXPECT_LT((mesh.outward_normal(e) - Vector(-1, 0)).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(length_of(mesh, part_of(mesh, "floor")), 2);
    EXPECT_DOUBLE_EQ(length_of(mesh, part_of(mesh, "wall")), 2);
    for (const BoundaryPart& part : mesh.boundary) EXPECT_EQ(breaks_of(mesh, part), 0);
  }
}

TEST(PolygonMesh, JoinsSidesOfTheSameNameInOrder) {
  const Mesh mesh = polygon_mesh({square, {}, {"rest", "slope", "rest", "rest"}}, 0.25);
  ASSERT_EQ(names_of(mesh), (std::vector<std::string>{"rest", "slope"}));
  EXPECT_DOUBLE_EQ(length_of(mesh, mesh.boundary[0]), 3);
  // The chain begins behind the slope, not at vertex 0 in its middle.
  EXPECT_EQ(breaks_of(mesh, mesh.boundary[0]), 0);
  EXPECT_EQ(mesh.edges[mesh.boundary[0].edges.front()][0], 2);
}

TEST(PolygonMesh, LeavesHolesOut) {
  const Polygon polygon = with_two_holes();
  const Mesh mesh = polygon_mesh(polygon, 0.4);
  expect_sound(mesh, polygon, 0.4);
  EXPECT_NEAR(area(polygon), 16 - 0.25 - 0.5, 1e-14);
  EXPECT_GT(smallest_angle(mesh), 20.7);
  EXPECT_NEAR(length_of(mesh, part_of(mesh, "hole0")), 2, 1e-14);
  EXPECT_NEAR(length_of(mesh, part_of(mesh, "hole1")), 2 + std::numbers::sqrt2, 1e-14);
  // The holes' vertices follow those of the outer ring.
  EXPECT_EQ(mesh.points[4], polygon.holes[0][0]);
  EXPECT_EQ(mesh.points[10], polygon.holes[1][2]);
}

TEST(PolygonMesh, PutsPointsOnTheSides) {
  const Polygon polygon{{{0.1, 0.2}, {7.3, 1.1}, {2.9, 5.7}}, {}, {}};
  const Mesh mesh = polygon_mesh(polygon, 0.3);
  expect_sound(mesh, polygon, 0.3);
  for (int side = 0; side < 3; ++side)
    for (const int e : mesh.boundary[side].edges)
      for (const int p : mesh.edges[e])
        EXPECT_LT(distance(mesh.points[p], Segment{polygon.vertices[side], polygon.vertices[(side + 1) % 3]}),
                  4e-15);
}

TEST(PolygonMesh, OfAHalfDiscOf400VerticesHonoursLocalSizes) {
  const Polygon polygon = half_disc();
  const std::vector<LocalSize> sizes{{{0, 0}, 0.1, 0.004}, {{0.5, 0.8}, 0, 0.02}};
  const Mesh mesh = polygon_mesh(polygon, 0.1, sizes);
  expect_sound(mesh, polygon, 0.1);
  EXPECT_GT(smallest_angle(mesh), 20.7);
  EXPECT_LT(mesh.triangles.size(), 60'000u);
  double longest_inside = 0, longest_at_point = 0, longest_outside = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    double longest = 0;
    for (const int e : mesh.triangle_edges[t]) longest = std::max(longest, mesh.length(e));
    if (distance(sizes[0].at, mesh.corners(t)) < 0.1) longest_inside = std::max(longest_inside, longest);
    if (distance(sizes[1].at, mesh.corners(t)) == 0) longest_at_point = std::max(longest_at_point, longest);
    longest_outside = std::max(longest_outside, longest);
  }
  EXPECT_LE(longest_inside, 0.004 * (1 + 1e-8));
  EXPECT_GT(longest_inside, 0.002);
  EXPECT_LE(longest_at_point, 0.02 * (1 + 1e-8));
  EXPECT_GT(longest_outside, 0.06);
}

TEST(PolygonMesh, IsTheSameInOtherUnits) {
  for (const Polygon& polygon : {Polygon{l_shape, {}, {}}, with_two_holes(), half_disc()}) {
    const Mesh mesh = polygon_mesh(polygon, 0.2, {{{1, 1}, 0.3, 0.03}});
    for (const double factor : {1e9, 1e-9, 3e5, 1e-120}) {
      const Mesh other = polygon_mesh(scaled(polygon, factor), 0.2 * factor,
                                      {{Point{1, 1} * factor, 0.3 * factor, 0.03 * factor}});
      ASSERT_EQ(other.triangles, mesh.triangles) << factor;
      EXPECT_EQ(other.boundary.size(), mesh.boundary.size());
      double farthest = 0;
      for (std::size_t i = 0; i < mesh.points.size(); ++i)
        farthest = std::max(farthest, (other.points[i] / factor - mesh.points[i]).norm());
      EXPECT_LT(farthest, 1e-11);
    }
  }
}

TEST(PolygonMesh, IsTheSameEveryTime) {
  const Polygon polygon = half_disc();
  const Mesh first = polygon_mesh(polygon, 0.05), second = polygon_mesh(polygon, 0.05);
  EXPECT_EQ(first.triangles, second.triangles);
  EXPECT_EQ(first.points, second.points);
}

TEST(PolygonMesh, CutsNoEdgeThatIsAsLongAsAsked) {
  for (const double side : {1.0, 0.1, 1e9 / 3, 1e-9 / 3}) {
    const Polygon triangle{{{0, 0}, {side, 0}, {0.5 * side, 0.8 * side}}, {}, {}};
    EXPECT_EQ(polygon_mesh(triangle, side).triangles.size(), 1u);
    EXPECT_GT(polygon_mesh(triangle, side * (1 - 1e-8)).triangles.size(), 1u);
  }
}

TEST(PolygonMesh, EndsAtSmallAnglesOfThePolygon) {
  const Polygon polygon{{{0, 0}, {1, 0}, {1, 0.01}, {0.4, 0.3}}, {}, {}};
  const Mesh mesh = polygon_mesh(polygon, 0.2);
  expect_sound(mesh, polygon, 0.2);
  EXPECT_GT(smallest_angle(mesh), 0.5);
  const Polygon needle{{{0, 0}, {1, 0}, {1, 1e-5}}, {}, {}};
  EXPECT_NEAR(polygon_mesh(needle, 0.2).area(), 5e-6, 1e-15);
}

TEST(PolygonMesh, HasNoMoreTrianglesThanAllowed) {
  const Polygon polygon{square, {}, {}};
  EXPECT_LE(polygon_mesh(polygon, 0.1, {}, 2000).triangles.size(), 2000u);
  const auto where = [&](const Polygon& domain, double size, const std::vector<LocalSize>& sizes) {
    try {
      polygon_mesh(domain, size, sizes, 2000);
    } catch (const InvalidProblem& invalid) {
      return invalid.faults().front().where;
    }
    return std::string("no fault");
  };
  EXPECT_EQ(where(polygon, 0.01, {}), "/mesh/size");
  EXPECT_EQ(where(polygon, 1e-6, {}), "/mesh/size");
  EXPECT_EQ(where(polygon, 1e-300, {}), "/mesh/size");
  EXPECT_EQ(where(polygon, 1, {{{0, 0}, 0.5, 0.01}}), "/mesh/size");
  // A strip whose width asks for more triangles than its area.
  EXPECT_EQ(where({{{0, 0}, {1, 0}, {1, 1e-4}, {0, 1e-4}}, {}, {}}, 1, {}), "/mesh/size");
}

TEST(PolygonFaults, NoneInSoundPolygons) {
  EXPECT_EQ(faults_of({square, {}, {}}), "");
  EXPECT_EQ(faults_of(with_two_holes()), "");
  EXPECT_EQ(faults_of(half_disc()), "");
  // A straight angle is no fault.
  EXPECT_EQ(faults_of({{{0, 0}, {0.5, 0}, {1, 0}, {0, 1}}, {}, {}}), "");
}

TEST(PolygonFaults, AreAllNamed) {
  const double nan = std::nan("");
  struct Case {
    Polygon polygon;
    std::string where, word;
  };
  const std::vector<Case> cases{
      {{{}, {}, {}}, "/domain/vertices", "three vertices"},
      {{{{0, 0}, {1, 0}}, {}, {}}, "/domain/vertices", "three vertices"},
      {{square, {{{0.2, 0.2}, {0.4, 0.4}}}, {}}, "/domain/holes/0", "three vertices"},
      {{{{0, 0}, {1, 0}, {nan, 1}}, {}, {}}, "/domain/vertices/2", "finite"},
      {{square, {{{0.2, 0.2}, {0.4, nan}, {0.3, 0.4}}}, {}}, "/domain/holes/0/1", "finite"},
      {{{{2, 2}, {2, 2}, {2, 2}}, {}, {}}, "/domain/vertices", "the same"},
      {{{{1e200, 0}, {0, 1e200}, {0, 0}}, {}, {}}, "/domain/vertices", "units"},
      {{box(1e12, 0, 1), {}, {}}, "/domain/vertices", "far from the origin"},
      {{{{0, 0}, {1, 0}, {1, 0}, {0, 1}}, {}, {}}, "/domain/vertices/2", "repeats /domain/vertices/1"},
      {{{{0, 0}, {1, 0}, {0, 1}, {0, 0}}, {}, {}}, "/domain/vertices/3", "closes by itself"},
      {{square, {{{0.2, 0.2}, {0.4, 0.2}, {1, 1}}}, {}}, "/domain/holes/0/2", "repeats /domain/vertices/2"},
      {{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, {}, {}}, "/domain/vertices/0", "begins at /domain/vertices/2"},
      {{{{0, 0}, {1, 0}, {0.5, 0}}, {}, {}}, "/domain/vertices/0", "crosses or touches"},
      {{{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}, {}, {}}, "/domain/vertices/0", "crosses or touches"},
      {{square, {box(0.5, 0.5, 1)}, {}}, "/domain/vertices/1", "/domain/holes/0"},
      {{square, {{{0.5, 0}, {0.6, 0.5}, {0.4, 0.5}}}, {}}, "/domain/vertices/0", "/domain/holes/0/"},
      {{square, {box(2, 2, 1)}, {}}, "/domain/holes/0", "inside the outer ring"},
      {{square, {box(-1, -1, 3)}, {}}, "/domain/holes/0", "inside the outer ring"},
      {{square, {box(0.2, 0.2, 0.6), box(0.4, 0.4, 0.1)}, {}}, "/domain/holes/1", "another hole"},
      {{square, {box(0.2, 0.2, 0.3), box(0.4, 0.4, 0.3)}, {}}, "/domain/holes/0/1", "/domain/holes/1/"},
      {{square, {}, {"a", "b", "c"}}, "/domain/sides", "each of the 4 edges, not 3"},
      {{square, {}, {"a", "", "c", "d"}}, "/domain/sides/1", "empty"},
      {{square, {}, {"a", "b", "c", "all"}}, "/domain/sides/3", "reserved"},
      {{square, {box(0.2, 0.2, 0.3)}, {"a", "b", "c", "hole0"}}, "/domain/sides/3", "hole"},
  };
  for (const Case& bad : cases)
    for (const double factor : {1.0, 1e9, 1e-9}) {
      const std::string faults = faults_of(scaled(bad.polygon, factor));
      EXPECT_NE(faults.find(bad.where + " "), std::string::npos) << bad.where << " not in: " << faults;
      EXPECT_NE(faults.find(bad.word), std::string::npos) << bad.word << " not in: " << faults;
      EXPECT_THROW(polygon_mesh(scaled(bad.polygon, factor), factor), InvalidProblem);
    }
}

/// As a hole and as a notch: the mesher ends the process where they are sharper than 1e-8.
TEST(PolygonFaults, AreAnglesThatAreTooSharp) {
  const auto with_hole = [](double width) {
    Polygon polygon;
    polygon.vertices = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    polygon.holes = {{{0.1, 0.5}, {0.9, 0.5}, {0.9, 0.5 + width}}};
    return polygon;
  };
  const auto with_notch = [](double width) {
    Polygon polygon;
    polygon.vertices = {{0, 0}, {1, 0}, {1, 0.5}, {0.2, 0.5}, {1, 0.5 + width}, {1, 1}, {0, 1}};
    return polygon;
  };
  for (const double width : {1e-7, 1e-8, 1e-9}) {
    EXPECT_EQ(validate(with_hole(width)).at(0).where, "/domain/holes/0/0") << width;
    EXPECT_EQ(validate(with_notch(width)).at(0).where, "/domain/vertices/3") << width;
  }
  EXPECT_TRUE(validate(with_hole(1e-5)).empty());
  EXPECT_TRUE(validate(with_notch(1e-5)).empty());
}

TEST(PolygonFaults, AreCountedBehindTheTenth) {
  Polygon star;
  for (int i = 0; i < 301; ++i) {
    const double angle = 2 * std::numbers::pi * 150 * i / 301;
    star.vertices.push_back({std::cos(angle), std::sin(angle)});
  }
  const auto faults = validate(star);
  EXPECT_GE(faults.size(), 10u);
  EXPECT_LE(faults.size(), 11u);
}

TEST(SizeFaults, AreAllNamed) {
  const auto where = [](double size, const LocalSize& local) {
    const auto faults = validate({square, {}, {}}, size, {local});
    return faults.empty() ? std::string() : faults.front().where;
  };
  const LocalSize sound{{0, 0}, 0, 0.1};
  EXPECT_EQ(where(0.1, sound), "");
  EXPECT_EQ(where(0, sound), "/mesh/size");
  EXPECT_EQ(where(-1, sound), "/mesh/size");
  EXPECT_EQ(where(std::nan(""), sound), "/mesh/size");
  EXPECT_EQ(where(1, {{0, std::nan("")}, 0, 1}), "/mesh/sizes/0/at");
  EXPECT_EQ(where(1, {{0, 0}, -1, 1}), "/mesh/sizes/0/radius");
  EXPECT_EQ(where(1, {{0, 0}, 1, 0}), "/mesh/sizes/0/size");
  EXPECT_EQ(where(1, {{0, 0}, 1, 1e-12}), "/mesh/sizes/0/size");
}

}  // namespace
}  // namespace signorini::polygon_test
