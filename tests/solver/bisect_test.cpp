#include "mesh/bisect.hpp"

#include <random>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "mesh/import.hpp"
#include "mesh/polygon.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/submesh.hpp"
#include "mesh_quality.hpp"

namespace signorini::bisect_test {
namespace {

/// A rectangle of each pattern, an L-shape with a hole, and a given mesh of thin triangles.
std::vector<Mesh> meshes() {
  std::vector<Mesh> all;
  for (const Pattern pattern : {Pattern::right, Pattern::left, Pattern::alternating, Pattern::crossed})
    all.push_back(rectangle_mesh({{0, 0}, {3, 1}}, {3, 2}, pattern));
  all.push_back(polygon_mesh(
      {{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {{{0.3, 0.3}, {0.6, 0.4}, {0.4, 0.6}}}, {}}, 0.5));
  all.push_back(import_mesh({{{0, 0}, {4, 0}, {4, 1}, {0, 1}, {1, 0.4}},
                             {{{0, 1, 4}}, {{1, 2, 4}}, {{2, 3, 4}}, {{3, 0, 4}}},
                             {{"floor", {{{0, 1}}}}, {"rest", {{{1, 2}}, {{2, 3}}, {{3, 0}}}}}}));
  return all;
}

std::vector<int> random_triangles(const Mesh& mesh, std::mt19937& engine) {
  std::vector<int> marked;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (engine() % 10 == 0) marked.push_back(t);
  return marked;
}

/// The triangles that have a point within the given distance.
std::vector<int> triangles_near(const Mesh& mesh, const Point& x, double distance) {
  std::vector<int> marked;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    for (const Point& corner : mesh.corners(t))
      if ((corner - x).norm() <= distance) {
        marked.push_back(t);
        break;
      }
  return marked;
}

/// The angles of all triangles, to six digits.
std::set<long> shapes(const Mesh& mesh) {
  std::set<long> angles;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto corners = mesh.corners(t);
    for (int i = 0; i < 3; ++i) {
      const Vector a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
      angles.insert(std::lround(1e6 * std::acos(a.normalized().dot(b.normalized()))));
    }
  }
  return angles;
}

TEST(Bisect, KeepsTheDomainItsPartsAndTheirOrder) {
  std::mt19937 engine(1);
  for (const Mesh& coarse : meshes()) {
    Mesh mesh = with_longest_edges_first(coarse);
    for (int level = 0; level < 6; ++level) mesh = bisect(mesh, random_triangles(mesh, engine));
    ASSERT_GT(mesh.triangles.size(), coarse.triangles.size());
    EXPECT_NEAR(mesh.area(), coarse.area(), 1e-13);
    EXPECT_EQ(misfiled_edges(mesh), 0);
    ASSERT_EQ(names_of(mesh), names_of(coarse));
    for (std::size_t p = 0; p < coarse.boundary.size(); ++p) {
      EXPECT_NEAR(length_of(mesh, mesh.boundary[p]), length_of(coarse, coarse.boundary[p]), 1e-13);
      EXPECT_EQ(breaks_of(mesh, mesh.boundary[p]), breaks_of(coarse, coarse.boundary[p]));
    }
    for (std::size_t p = 0; p < coarse.points.size(); ++p) EXPECT_EQ(mesh.points[p], coarse.points[p]);
  }
}

TEST(Bisect, TellsTheParentOfEveryTriangle) {
  std::mt19937 engine(2);
  for (const Mesh& given : meshes()) {
    const Mesh coarse = with_longest_edges_first(given);
    std::vector<int> parents;
    const Mesh fine = bisect(coarse, random_triangles(coarse, engine), parents);
    ASSERT_EQ(parents.size(), fine.triangles.size());
    for (int t = 0; t < static_cast<int>(parents.size()); ++t) {
      const auto [a, b, c] = coarse.corners(parents[t]);
      Eigen::Matrix2d jacobian;
      jacobian << b - a, c - a;
      const Point inside = jacobian.inverse() * (fine.centroid(t) - a);
      EXPECT_GT(std::min({inside.x(), inside.y(), 1 - inside.sum()}), 0.01);
    }
  }
}

TEST(Submesh, HasItsTrianglesItsPartsAndTheCut) {
  std::mt19937 engine(3);
  for (const Mesh& whole : meshes()) {
    std::vector<int> triangles;
    for (int t = 0; t < static_cast<int>(whole.triangles.size()); ++t)
      if (engine() % 3) triangles.push_back(t);
    const auto [mesh, cut] = Submesh(whole, triangles);
    ASSERT_EQ(mesh.triangles.size(), triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
      EXPECT_EQ(mesh.corners(static_cast<int>(i)), whole.corners(triangles[i]));
    // Every edge of the boundary lies in one part, in the cut or in that of the whole.
    EXPECT_EQ(misfiled_edges(mesh), 0);
    const BoundaryPart& last = mesh.boundary.back();
    ASSERT_EQ(last.name, Submesh::kCut);
    ASSERT_EQ(last.edges.size(), cut.size());
    for (std::size_t i = 0; i < cut.size(); ++i) EXPECT_EQ(mesh.length(last.edges[i]), whole.length(cut[i]));
    std::set<std::string> names{Submesh::kCut};
    for (const BoundaryPart& part : whole.boundary) names.insert(part.name);
    for (const BoundaryPart& part : mesh.boundary) EXPECT_TRUE(names.erase(part.name)) << part.name;
  }
}

TEST(Bisect, HalvesEveryEdgeOfAMarkedTriangle) {
  const Mesh coarse = with_longest_edges_first(rectangle_mesh({}, {4, 4}, Pattern::right));
  const Mesh fine = bisect(coarse, {5});
  std::set<std::pair<double, double>> points;
  for (const Point& x : fine.points) points.insert({x.x(), x.y()});
  const auto corners = coarse.corners(5);
  for (int e = 0; e < 3; ++e) {
    const Point middle = 0.5 * (corners[(e + 1) % 3] + corners[(e + 2) % 3]);
    EXPECT_TRUE(points.contains({middle.x(), middle.y()}));
  }
  // Newest-vertex bisection stays local: the marked triangle and those that share its edges.
  EXPECT_LE(fine.triangles.size(), coarse.triangles.size() + 12);
}

TEST(Bisect, KeepsAnglesOverFortyLevelsTowardsAPoint) {
  for (const Mesh& coarse : meshes()) {
    Mesh mesh = with_longest_edges_first(coarse);
    const Point corner = mesh.points[0];
    for (int level = 0; level < 40; ++level) mesh = bisect(mesh, triangles_near(mesh, corner, 0));
    EXPECT_GT(smallest_angle(mesh), 0.5 * smallest_angle(coarse) - 1e-9);
    EXPECT_EQ(misfiled_edges(mesh), 0);
    double shortest = mesh.length(0);
    for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e)
      shortest = std::min(shortest, mesh.length(e));
    EXPECT_LT(shortest, 1e-11);
    EXPECT_LT(mesh.triangles.size(), 3000u);
  }
}

TEST(Bisect, MakesAtMostFourShapesOfATriangle) {
  std::mt19937 engine(7);
  Mesh mesh = with_longest_edges_first(import_mesh(
      {{{0, 0}, {1.3, 0.1}, {0.4, 0.9}}, {{{0, 1, 2}}}, {{"ring", {{{0, 1}}, {{1, 2}}, {{2, 0}}}}}}));
  mesh = bisect(mesh, {0});
  for (int level = 0; level < 12; ++level) mesh = bisect(mesh, random_triangles(mesh, engine));
  EXPECT_LE(shapes(mesh).size(), 12u);
}

TEST(Bisect, OfNothingChangesNothing) {
  const Mesh mesh = rectangle_mesh({}, {3, 2}, Pattern::crossed);
  EXPECT_EQ(bisect(mesh, {}).triangles, mesh.triangles);
}

}  // namespace
}  // namespace signorini::bisect_test
