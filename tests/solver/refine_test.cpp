#include "mesh/refine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh_quality.hpp"

namespace signorini::refine_test {
namespace {

TEST(Refine, CutsEveryTriangleInFourSimilarOnes) {
  const Mesh coarse = polygon_mesh({{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {}, {}}, 0.5);
  const Mesh fine = refine(coarse, 2);
  EXPECT_EQ(fine.triangles.size(), 16 * coarse.triangles.size());
  EXPECT_NEAR(fine.area(), coarse.area(), 1e-14);
  EXPECT_NEAR(smallest_angle(fine), smallest_angle(coarse), 1e-9);
  EXPECT_NEAR(longest_edge(fine), longest_edge(coarse) / 4, 1e-14);
  for (std::size_t p = 0; p < coarse.points.size(); ++p) EXPECT_EQ(fine.points[p], coarse.points[p]);
}

/// The arc over its side reaches beyond the opposite corner of a flat triangle.
TEST(Refine, RefusesTrianglesThatAnArcTurnsOver) {
  const Mesh flat =
      make_mesh({{0, 0}, {1, 0}, {0.5, 0.05}}, {{0, 1, 2}}, {"arc", "rest"},
                {{{0, 1}, 0, 0}, {{1, 2}, 1}, {{2, 0}, 1}}, {Circle{{0.5, -0.5}, std::sqrt(0.5)}});
  EXPECT_THROW(refine(flat, 1), InvalidProblem);
}

TEST(Refine, KeepsPartsAndTheirOrder) {
  // The rectangle's parts run in ascending x or y, against the domain on two sides.
  const Mesh coarse = rectangle_mesh({{0, 0}, {3, 2}}, {3, 2}, Pattern::right);
  const Mesh fine = refine(coarse, 1), same = rectangle_mesh({{0, 0}, {3, 2}}, {6, 4}, Pattern::right);
  ASSERT_EQ(names_of(fine), names_of(same));
  EXPECT_EQ(misfiled_edges(fine), 0);
  const auto middle = [](const Mesh& mesh, int edge) {
    return Point(0.5 * (mesh.points[mesh.edges[edge][0]] + mesh.points[mesh.edges[edge][1]]));
  };
  for (std::size_t part = 0; part < fine.boundary.size(); ++part) {
    ASSERT_EQ(fine.boundary[part].edges.size(), same.boundary[part].edges.size());
    for (std::size_t i = 0; i < fine.boundary[part].edges.size(); ++i)
      EXPECT_EQ(middle(fine, fine.boundary[part].edges[i]), middle(same, same.boundary[part].edges[i]));
  }
}

TEST(Refine, ZeroTimesChangesNothing) {
  const Mesh mesh = rectangle_mesh({}, {3, 2}, Pattern::crossed);
  EXPECT_EQ(refine(mesh, 0).triangles, mesh.triangles);
}

TEST(Refine, HasNoMoreTrianglesThanAllowed) {
  const Mesh mesh = rectangle_mesh({}, {1, 1}, Pattern::right);
  EXPECT_EQ(refine(mesh, 3, 128).triangles.size(), 128u);
  EXPECT_THROW(refine(mesh, 3, 127), InvalidProblem);
  EXPECT_THROW(refine(mesh, 2'000'000'000), InvalidProblem);
}

}  // namespace
}  // namespace signorini::refine_test
