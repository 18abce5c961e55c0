// Meshes sent by a client: mended, kept in order, or refused with the offending numbers.
#include "mesh/import.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "mesh/rectangle.hpp"
#include "mesh_quality.hpp"
#include "problems/membrane.hpp"

namespace signorini::import_test {
namespace {

/// Two triangles on the unit square.
MeshData square() {
  return {{{0, 0}, {1, 0}, {1, 1}, {0, 1}},
          {{0, 1, 2}, {0, 2, 3}},
          {{"bottom", {{0, 1}}}, {"rest", {{3, 0}, {1, 2}, {2, 3}}}}};
}

MeshData data_of(const Mesh& mesh) {
  MeshData data{mesh.points, mesh.triangles, {}};
  for (const BoundaryPart& part : mesh.boundary) {
    data.boundary.push_back({part.name, {}});
    for (const int edge : part.edges) data.boundary.back().second.push_back(mesh.edges[edge]);
  }
  return data;
}

/// Names every edge of the boundary (those with one triangle) that no part has.
MeshData with_boundary(MeshData data) {
  std::vector<std::array<int, 2>> edges;
  for (const auto& t : data.triangles)
    for (int e = 0; e < 3; ++e)
      edges.push_back({std::min(t[e], t[(e + 1) % 3]), std::max(t[e], t[(e + 1) % 3])});
  std::ranges::sort(edges);
  data.boundary = {{"rest", {}}};
  for (const auto& edge : edges)
    if (std::ranges::count(edges, edge) == 1) data.boundary[0].second.push_back(edge);
  return data;
}

MeshData scaled(MeshData data, double factor) {
  for (Point& x : data.points) x *= factor;
  return data;
}

std::string faults_of(const MeshData& data) {
  try {
    import_mesh(data);
  } catch (const InvalidProblem& invalid) {
    std::string text;
    for (const Fault& fault : invalid.faults()) text += fault.where + " " + fault.detail + "\n";
    return text;
  }
  return {};
}

TEST(ImportMesh, KeepsNumbersPartsAndArea) {
  const Mesh given = rectangle_mesh({{0, 0}, {2, 1}}, {8, 5}, Pattern::alternating);
  const Mesh mesh = import_mesh(data_of(given));
  EXPECT_EQ(mesh.points, given.points);
  EXPECT_EQ(mesh.triangles, given.triangles);
  EXPECT_EQ(names_of(mesh), names_of(given));
  EXPECT_EQ(misfiled_edges(mesh), 0);
}

TEST(ImportMesh, TurnsClockwiseTriangles) {
  MeshData data = square();
  data.triangles[1] = {0, 3, 2};
  const Mesh mesh = import_mesh(data);
  EXPECT_DOUBLE_EQ(mesh.area(), 1);
  EXPECT_GT(smallest_angle(mesh), 44);
}

TEST(ImportMesh, PutsTheEdgesOfAPartInOrder) {
  const Mesh mesh = import_mesh(square());
  const BoundaryPart& rest = part_of(mesh, "rest");
  ASSERT_EQ(rest.edges.size(), 3u);
  EXPECT_EQ(breaks_of(mesh, rest), 0);
  EXPECT_EQ(mesh.edges[rest.edges[0]], (std::array{1, 2}));
  EXPECT_EQ(mesh.edges[rest.edges[2]], (std::array{0, 3}));
}

TEST(ImportMesh, AcceptsHolesAndPointsWhereTwoPartsMeet) {
  // A square ring around a hole, in which a triangle stands apart; and one that touches the ring at a point.
  MeshData data{{{0, 0},
                 {4, 0},
                 {4, 4},
                 {0, 4},
                 {1, 1},
                 {3, 1},
                 {3, 3},
                 {1, 3},
                 {1.5, 1.5},
                 {2, 1.5},
                 {1.5, 2},
                 {5, 4},
                 {5, 5}},
                {{0, 1, 5},
                 {0, 5, 4},
                 {1, 2, 6},
                 {1, 6, 5},
                 {2, 3, 7},
                 {2, 7, 6},
                 {3, 0, 4},
                 {3, 4, 7},
                 {8, 9, 10},
                 {2, 11, 12}},
                {}};
  for (const double factor : {1.0, 1e9, 1e-9}) EXPECT_EQ(faults_of(scaled(with_boundary(data), factor)), "");
}

/// Two squares that meet in the point 1 alone, each of four triangles.
MeshData two_squares() {
  return {{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {1, -1}, {2, -1}, {.5, .5}, {1.5, -.5}},
          {{0, 1, 7}, {1, 2, 7}, {2, 3, 7}, {3, 0, 7}, {5, 6, 8}, {6, 4, 8}, {4, 1, 8}, {1, 5, 8}},
          {{"above", {{2, 3}, {3, 0}}},
           {"below", {{5, 6}}},
           {"free", {{1, 4}, {4, 6}, {1, 5}}},
           {"contact", {{0, 1}, {1, 2}}}}};
}

TEST(ImportMesh, GivesEveryWingAPointOfItsOwn) {
  const Mesh mesh = import_mesh(two_squares());
  ASSERT_EQ(mesh.points.size(), 10u);
  EXPECT_EQ(mesh.points[9], mesh.points[1]);
  for (int t = 0; t < 8; ++t)
    for (const int point : mesh.triangles[t]) EXPECT_FALSE(point == (t < 4 ? 9 : 1)) << t;
  ASSERT_EQ(mesh.notes.size(), 1u);
  EXPECT_NE(mesh.notes[0].find("(1, 0)"), std::string::npos);
  EXPECT_TRUE(import_mesh(square()).notes.empty());
}

/// Many points shared by all wings of a chessboard, and one by very many wings.
TEST(ImportMesh, SeparatesManyWings) {
  const Mesh board = rectangle_mesh({{0, 0}, {1, 1}}, {41, 41}, Pattern::right);
  MeshData black{board.points, {}, {}};
  for (int t = 0; t < static_cast<int>(board.triangles.size()); ++t)
    if ((t / 2 % 41 + t / 82) % 2 == 0) black.triangles.push_back(board.triangles[t]);
  const Mesh squares = import_mesh(with_boundary(black));
  EXPECT_EQ(squares.points.size(), 4 * squares.triangles.size() / 2);

  MeshData star{{{0, 0}}, {}, {}};
  constexpr int wings = 500;
  for (int i = 0; i < 2 * wings; ++i) {
    const double angle = 3.141592653589793 * i / wings;
    star.points.push_back({std::cos(angle), std::sin(angle)});
    if (i % 2 == 1) star.triangles.push_back({0, i, i + 1});
  }
  EXPECT_EQ(import_mesh(with_boundary(star)).points.size(), 3u * wings);
}

/// A point does not hold two parts of a membrane together, so that meshes approach the truth.
TEST(ImportMesh, LetsWingsMoveApart) {
  Problem problem;
  problem.domain = two_squares();
  problem.scheme = Scheme::conforming;
  problem.body = problems::formula("x > 1 ? 1 : (x + y > 1.2 ? -3 : 2)");
  problem.boundary = {{"above", Fixed{}}, {"below", Fixed{}}, {"contact", Contact{0.02}}};
  std::vector<ErrorBound> bounds;
  for (const int refine : {0, 2, 4}) {
    problem.mesh.refine = refine;
    bounds.push_back(*solve(problem, {ActiveSet{}, {}}).summary.error_bound);
    EXPECT_TRUE(bounds.back().guaranteed);
    EXPECT_LE(bounds.front().energy_lower, bounds.back().energy_upper);
    EXPECT_GE(bounds.front().energy_upper, bounds.back().energy_lower);
  }
  EXPECT_LT(bounds.back().relative, 0.02);
}

TEST(ImportMesh, RefusesFaultsByNumber) {
  const double nan = std::nan("");
  struct Case {
    const char* what;
    std::function<void(MeshData&)> spoil;
    std::string where, word;
  };
  const std::vector<Case> cases{
      {"no points", [](MeshData& d) { d.points.clear(); }, "/domain/points", "empty"},
      {"no triangles", [](MeshData& d) { d.triangles.clear(); }, "/domain/triangles", "empty"},
      {"not finite", [&](MeshData& d) { d.points[2].x() = nan; }, "/domain/points/2", "finite"},
      {"index", [](MeshData& d) { d.triangles[1][2] = 4; }, "/domain/triangles/1", "no point 4"},
      {"negative", [](MeshData& d) { d.triangles[1][2] = -1; }, "/domain/triangles/1", "no point -1"},
      {"twice",
       [](MeshData& d) {
         d.triangles[1] = {0, 2, 2};
       },
       "/domain/triangles/1", "0-2-2"},
      {"edge index",
       [](MeshData& d) {
         d.boundary[0].second[0] = {0, 9};
       },
       "/domain/boundary/bottom/0", "9"},
      {"edge twice",
       [](MeshData& d) {
         d.boundary[0].second[0] = {1, 1};
       },
       "/domain/boundary/bottom/0", "1-1"},
      {"repeated point", [](MeshData& d) { d.points[3] = d.points[1]; }, "/domain/points/3", "point 1"},
      {"unused",
       [](MeshData& d) {
         d.points.push_back({5, 5});
       },
       "/domain/points/4", "no triangle"},
      {"degenerate",
       [](MeshData& d) {
         d.points[1] = {0.5, 0.5};
       },
       "/domain/triangles/0", "0-1-2"},
      {"sliver",
       [](MeshData& d) {
         d.points[1] = {0.5, 0.5 - 1e-9};
       },
       "/domain/triangles/0", "degenerate"},
      {"repeated triangle",
       [](MeshData& d) {
         d.triangles.push_back({2, 0, 1});
       },
       "/domain/triangles/2", "repeats triangle 0"},
      {"third triangle",
       [](MeshData& d) {
         d.points.push_back({-1, 3});
         d.triangles.push_back({0, 2, 4});
       },
       "/domain/triangles/2", "after 0 and 1"},
      {"folded",
       [](MeshData& d) {
         d.points.push_back({0.5, 0.8});
         d.triangles.push_back({0, 1, 4});
       },
       "/domain/triangles/2", "overlaps triangle 0"},
      {"unknown edge",
       [](MeshData& d) {
         d.boundary[0].second[0] = {1, 3};
       },
       "/domain/boundary/bottom/0", "no edge of a triangle"},
      {"interior",
       [](MeshData& d) {
         d.boundary[0].second.push_back({2, 0});
       },
       "/domain/boundary/bottom/1", "between triangles 0 and 1"},
      {"same part",
       [](MeshData& d) {
         d.boundary[0].second.push_back({1, 0});
       },
       "/domain/boundary/bottom/1", "already"},
      {"two parts",
       [](MeshData& d) {
         d.boundary[1].second.push_back({0, 1});
       },
       "/domain/boundary/rest/3", "/domain/boundary/bottom"},
      {"missing", [](MeshData& d) { d.boundary[1].second.pop_back(); }, "/domain/boundary", "2-3"},
      {"empty part",
       [](MeshData& d) {
         d.boundary.push_back({"a/b~", {}});
       },
       "/domain/boundary/a~1b~0", "at least one"},
      {"empty name", [](MeshData& d) { d.boundary[0].first = ""; }, "/domain/boundary/", "empty"},
      {"all", [](MeshData& d) { d.boundary[0].first = "all"; }, "/domain/boundary/all", "reserved"},
      {"same name", [](MeshData& d) { d.boundary[0].first = "rest"; }, "/domain/boundary/rest", "two parts"},
      {"far away",
       [](MeshData& d) {
         for (Point& x : d.points) x.x() += 1e12;
       },
       "/domain/points", "far from the origin"},
  };
  for (const Case& bad : cases) {
    MeshData data = square();
    bad.spoil(data);
    for (const double factor : {1.0, 1e9, 1e-9}) {
      const std::string faults = faults_of(scaled(data, factor));
      EXPECT_NE(faults.find(bad.where + " "), std::string::npos) << bad.what << ": " << faults;
      EXPECT_NE(faults.find(bad.word), std::string::npos) << bad.what << ": " << faults;
    }
  }
}

/// Refused at every scale, with the words.
void expect_refused(const MeshData& data, const std::string& word) {
  for (const double factor : {1.0, 1e9, 1e-9}) {
    const std::string faults = faults_of(scaled(with_boundary(data), factor));
    EXPECT_NE(faults.find(word), std::string::npos) << word << " not in: " << faults;
  }
}

TEST(ImportMesh, RefusesHangingNodes) {
  // Point 4 halves the diagonal of the lower triangle only; thirds do not lie on it exactly.
  const Point middle = Point{1, 1} / 3;
  expect_refused({{{0, 0}, {1, 0}, {1, 1}, {0, 1}, middle}, {{0, 1, 4}, {1, 2, 4}, {0, 2, 3}}, {}},
                 "/domain/points/4 is a hanging node");
  // The same with the point a little off the edge.
  expect_refused(
      {{{0, 0}, {1, 0}, {1, 1}, {0, 1}, middle + Vector(1e-13, 0)}, {{0, 1, 4}, {1, 2, 4}, {0, 2, 3}}, {}},
      "/domain/points/4 is a hanging node");
}

TEST(ImportMesh, RefusesPointsThatNearlyRepeatAnother) {
  expect_refused({{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 1e-14}}, {{0, 1, 2}, {4, 2, 3}}, {}},
                 "repeats point 0");
}

TEST(ImportMesh, RefusesOverlapsOfTrianglesWithoutCommonPoints) {
  // Boundaries that cross.
  expect_refused({{{0, 0}, {2, 0}, {0, 2}, {0.5, 0.5}, {3, 0.6}, {3, 3}}, {{0, 1, 2}, {3, 4, 5}}, {}},
                 "cross");
  // One inside another, along no line with it.
  expect_refused({{{0, 0}, {4, 0}, {0, 4}, {1, 1}, {1.5, 1}, {1, 1.5}}, {{0, 1, 2}, {3, 4, 5}}, {}},
                 "lies inside the mesh");
  // One that hangs inside another by a corner.
  expect_refused({{{0, 0}, {4, 0}, {0, 4}, {1.5, 1}, {1, 1.5}}, {{0, 1, 2}, {0, 3, 4}}, {}},
                 "lies inside the mesh");
}

TEST(ImportMesh, RefusesAFanThatWindsTwice) {
  // Around point 0, ten triangles of 72°: locally sound everywhere but at the centre.
  MeshData data{{{0, 0}}, {}, {}};
  for (int i = 0; i < 10; ++i) {
    const double angle = 2 * std::numbers::pi * 2 * i / 10, radius = 1 + 0.05 * i;
    data.points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    data.triangles.push_back({0, i + 1, (i + 1) % 10 + 1});
  }
  expect_refused(data, "overlaps");
}

TEST(ImportMesh, ListsTenFaultsAndCountsTheRest) {
  MeshData data = data_of(rectangle_mesh({}, {20, 20}, Pattern::right));
  data.boundary.clear();
  const std::string faults = faults_of(data);
  EXPECT_EQ(std::ranges::count(faults, '\n'), 11);
  EXPECT_NE(faults.find("there are 70 more edges"), std::string::npos) << faults;
}

TEST(ImportMesh, TakesLargeMeshesInItsStride) {
  const Mesh given = rectangle_mesh({}, {400, 400}, Pattern::crossed);
  EXPECT_EQ(import_mesh(data_of(given)).triangles.size(), 640'000u);
}

}  // namespace
}  // namespace signorini::import_test
