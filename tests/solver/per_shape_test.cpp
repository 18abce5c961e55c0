#include "fem/per_shape.hpp"

#include <gtest/gtest.h>

#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"

namespace signorini::per_shape_test {
namespace {

/// How many values are made for the triangles of a mesh.
int shapes_of(const Mesh& mesh) {
  const Problem problem = problems::paper(Scheme::nonconforming, 1);
  const Discretization discretization(problem, mesh);
  PerShape<int> shapes(discretization);
  int made = 0;
  for (int t = 0; t < discretization.triangles(); ++t) shapes(t, [&] { return made++; });
  return made;
}

/// i/48 of a length is rounded otherwise for each i.
TEST(PerShape, TellsShapesApartButForRounding) {
  const Rectangle domain{{0.1, 0}, {1.7, 0.3}};
  Mesh mesh = rectangle_mesh(domain, {48, 48}, Pattern::crossed);
  EXPECT_LE(shapes_of(mesh), 8);
  const int before = shapes_of(mesh);
  // A point inside has four triangles in its own square.
  mesh.points.back() += Vector(1e-9 * 1.7 / 48, 0);
  EXPECT_EQ(shapes_of(mesh), before + 4);
}

/// Some of them have one place among those that are remembered.
TEST(PerShape, RemembersThoseThatComeInTurn) {
  for (const Pattern pattern : {Pattern::right, Pattern::crossed})
    for (int n = 2; n < 100; ++n) {
      EXPECT_LE(shapes_of(rectangle_mesh({{0, 0}, {1, 9. / n}}, {9, n}, pattern)), 4) << n;
      EXPECT_LE(shapes_of(rectangle_mesh({{0.1, 0}, {1, 1.7}}, {9, n}, pattern)), 4) << n;
    }
  EXPECT_EQ(shapes_of(rectangle_mesh({{0, 0}, {9. / 333, 1}}, {9, 333}, Pattern::right)), 2);
}

}  // namespace
}  // namespace signorini::per_shape_test
