#include "mesh/stability.hpp"

#include <gtest/gtest.h>

#include "mesh/import.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"
#include "mesh_quality.hpp"

namespace signorini {
namespace {

int most_boundary_edges(const Mesh& mesh) {
  int most = 0;
  for (const auto& edges : mesh.triangle_edges)
    most = std::max(most, static_cast<int>(std::ranges::count_if(
                              edges, [&](int e) { return mesh.edge_triangles[e][1] < 0; })));
  return most;
}

Mesh triangle() {
  return import_mesh({{{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}, {{"a", {{0, 1}}}, {"b", {{1, 2}, {2, 0}}}}});
}

void expect_repaired(const Mesh& mesh) {
  const Mesh repaired = split_corners(mesh);
  EXPECT_EQ(most_boundary_edges(repaired), 1);
  EXPECT_NEAR(repaired.area(), mesh.area(), 1e-14 * mesh.area());
  EXPECT_EQ(misfiled_edges(repaired), 0);
  EXPECT_GT(smallest_angle(repaired), smallest_angle(mesh) / 3);
  ASSERT_EQ(names_of(repaired), names_of(mesh));
  for (std::size_t part = 0; part < mesh.boundary.size(); ++part) {
    ASSERT_EQ(repaired.boundary[part].edges.size(), mesh.boundary[part].edges.size());
    for (std::size_t i = 0; i < mesh.boundary[part].edges.size(); ++i)
      EXPECT_EQ(repaired.edges[repaired.boundary[part].edges[i]], mesh.edges[mesh.boundary[part].edges[i]]);
  }
  for (std::size_t p = 0; p < mesh.points.size(); ++p) EXPECT_EQ(repaired.points[p], mesh.points[p]);
}

TEST(SplitCorners, RepairsCornersOfASquare) {
  expect_repaired(rectangle_mesh({}, {3, 3}, Pattern::right));
  expect_repaired(rectangle_mesh({}, {1, 1}, Pattern::right));
  expect_repaired(rectangle_mesh({}, {1, 4}, Pattern::alternating));
}

TEST(SplitCorners, RepairsTrianglesBetweenSeveralCorners) {
  // Three corners around one triangle; and two of them.
  expect_repaired(refine(triangle(), 1));
  expect_repaired(import_mesh({{{0, 0}, {4, 0}, {1, 3}, {2, -2}, {4, 2}},
                               {{0, 1, 2}, {0, 3, 1}, {1, 4, 2}},
                               {{"a", {{0, 3}, {3, 1}, {1, 4}, {4, 2}, {2, 0}}}}}));
}

TEST(SplitCorners, RepairsATriangleByItself) {
  expect_repaired(triangle());
}

TEST(SplitCorners, RepairsPolygons) {
  expect_repaired(polygon_mesh({{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {}, {}}, 0.5));
  expect_repaired(polygon_mesh({{{0, 0}, {1, 0}, {1, 1e-3}, {0.4, 0.3}}, {}, {}}, 0.2));
}

TEST(SplitCorners, LeavesOtherMeshesAsTheyAre) {
  const Mesh mesh = rectangle_mesh({}, {3, 2}, Pattern::crossed);
  const Mesh same = split_corners(mesh);
  EXPECT_EQ(same.points, mesh.points);
  EXPECT_EQ(same.triangles, mesh.triangles);
}

TEST(SplitCorners, ChangesOnlyTheNeighbours) {
  const Mesh mesh = rectangle_mesh({}, {10, 10}, Pattern::right);
  EXPECT_EQ(split_corners(mesh).triangles.size(), mesh.triangles.size() + 4);
}

}  // namespace
}  // namespace signorini
