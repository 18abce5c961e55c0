// Polygons that leave a mesh little room: each gets one soon, or a word that names the place.
#include "mesh/narrow_places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <numbers>
#include <random>
#include <utility>

#include "mesh/clusters.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/mesh_sizes.hpp"
#include "mesh/polygon.hpp"
#include "mesh_quality.hpp"

namespace signorini::narrow_places_test {
namespace {

const std::vector<Point> kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/// A hole with a side along the edge of the square, at a distance.
Polygon beside(double distance) {
  return {kSquare, {{{0.3, distance}, {0.6, distance}, {0.6, 0.5}, {0.3, 0.5}}}, {}};
}

/// A hole with a corner that comes so close.
Polygon pointed(double distance) {
  return {kSquare, {{{0.5, distance}, {0.6, 0.2}, {0.5, 0.4}, {0.4, 0.2}}}, {}};
}

Polygon wedge(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {{{0, 0}, {1, 0}, {std::cos(angle), std::sin(angle)}}, {}, {}};
}

Polygon strip(double aspect) {
  return {{{0, 0}, {aspect, 0}, {aspect, 1}, {0, 1}}, {}, {}};
}

/// A band of a height that goes up and down between its ends.
Polygon zigzag(int teeth, double height) {
  Polygon polygon;
  for (int i = 0; i <= teeth; ++i) polygon.vertices.push_back({1. * i / teeth, i % 2});
  for (int i = teeth; i >= 0; --i) polygon.vertices.push_back({1. * i / teeth, i % 2 - height});
  return polygon;
}

/// A slit in the domain, which needs no triangles.
Polygon slit(double width) {
  return {
      {{0, 0}, {1, 0}, {1, 1}, {0.5 + width, 1}, {0.5 + width, 0.2}, {0.5, 0.2}, {0.5, 1}, {0, 1}}, {}, {}};
}

Polygon scaled(Polygon polygon, double scale) {
  for (Point& x : polygon.vertices) x *= scale;
  for (auto& hole : polygon.holes)
    for (Point& x : hole) x *= scale;
  return polygon;
}

double counted(const Polygon& polygon) {
  const Rings rings(polygon);
  const Rings unit = rings.within(UnitFrame(rings.points));
  return narrow_places(unit, near_edges(unit, most_near_pairs), 1e6).triangles;
}

double seconds_of(const auto& act) {
  const auto start = std::chrono::steady_clock::now();
  act();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(NarrowPlaces, AreCountedAsTheMesherCuts) {
  for (const Polygon& polygon : {beside(1e-3), beside(1e-4), wedge(1), wedge(0.1), wedge(0.01), strip(100),
                                 strip(5000), zigzag(20, 0.01), zigzag(30, 0.01)}) {
    const auto triangles =
        static_cast<double>(polygon_mesh(polygon, 1e5 * polygon.vertices[1].x()).triangles.size());
    EXPECT_LT(counted(polygon), 3 * triangles);
    EXPECT_GT(counted(polygon), triangles / 4);
  }
}

/// The sizes that are foreseen of a mesh are hardly below its own, and seldom twice as large.
void expect_foreseen(const Polygon& polygon, const MeshRequest& request, double least = 0.95) {
  const auto expect = [&](std::int64_t foreseen, std::int64_t made) {
    const double ratio = static_cast<double>(foreseen) / static_cast<double>(made);
    EXPECT_GT(ratio, least);
    EXPECT_LT(ratio, 2.5);
  };
  const Domain domain = polygon;
  const MeshSizes foreseen = PredictedSizes(domain)(request),
                  made = sizes_of(make_domain_mesh(domain, request));
  expect(foreseen.triangles, made.triangles);
  for (std::size_t part = 0; part < made.parts.size(); ++part)
    if (made.parts[part].edges > 100) expect(foreseen.parts[part].edges, made.parts[part].edges);
}

TEST(NarrowPlaces, CutTheBoundaryToo) {
  for (const Polygon& polygon : {strip(500), strip(2000), strip(5000), wedge(0.1), wedge(0.01), beside(1e-3),
                                 zigzag(20, 0.01), zigzag(30, 0.01)}) {
    SCOPED_TRACE(std::to_string(polygon.vertices.size()) + " vertices, " + std::to_string(counted(polygon)));
    expect_foreseen(polygon, MeshRequest(LargestEdge{polygon.vertices[1].x()}));
  }
}

/// A strip whose floor rises and falls, `teeth` times; each flank takes so much of a tooth's width.
Polygon toothed(int teeth, double height, double foot, double flank) {
  Polygon polygon;
  const double width = 2. / teeth, top = 1 - foot - 2 * flank;
  for (int i = 0; i < teeth; ++i) {
    const double at = i * width;
    polygon.vertices.push_back({at, 0});
    if (foot > 0) polygon.vertices.push_back({at + foot * width, 0});
    polygon.vertices.push_back({at + (foot + flank) * width, height});
    if (top > 0) polygon.vertices.push_back({at + (foot + flank + top) * width, height});
  }
  polygon.sides.assign(polygon.vertices.size() + 1, "floor");
  for (const Point& corner : {Point(2, 0), Point(2, 1), Point(0, 1)}) polygon.vertices.push_back(corner);
  for (const char* const side : {"right", "left"}) polygon.sides.push_back(side);
  return polygon;
}

/// What is foreseen of a mesh, and what it has.
std::pair<MeshSizes, MeshSizes> foreseen_and_made(const Domain& domain, double size) {
  const MeshRequest request(LargestEdge{size});
  return {PredictedSizes(domain)(request), sizes_of(make_domain_mesh(domain, request))};
}

/// A mesh has no more triangles and edges of its boundary than so many times those that are foreseen.
void expect_no_more(const Polygon& polygon, double size, double triangles, double edges) {
  const auto [foreseen, made] = foreseen_and_made(polygon, size);
  EXPECT_GE(triangles * static_cast<double>(foreseen.triangles), static_cast<double>(made.triangles));
  EXPECT_GE(edges * static_cast<double>(foreseen.edges_of_parts()),
            static_cast<double>(made.edges_of_parts()));
}

/// Found from outside: between them the mesher cuts for the angles of its triangles, more often than their
/// width asks for.
TEST(NarrowPlaces, BetweenTeethAreCutForTheirAngles) {
  const auto expect = [](const Polygon& polygon, double size) { expect_no_more(polygon, size, 1.02, 1.15); };
  for (const double size : {0.05, 0.2, 0.5})
    for (double steepness = 1; steepness < 40; steepness *= 1.25) {
      SCOPED_TRACE(std::to_string(size) + ", steepness " + std::to_string(steepness));
      expect(toothed(120, steepness / 120, 0, 0.5), size);
      expect(toothed(80, 0.4 * steepness / 80, 0.3, 0.2), size);
      expect(toothed(60, 0.4 * steepness / 60, 0.45, 0.02), size);
    }
}

/// Two discs in a plate, or a disc and a side, so far from each other.
Polygon plate_with(const std::vector<std::pair<Point, double>>& discs) {
  Polygon plate{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {}, {}};
  for (const auto& [centre, radius] : discs) {
    plate.arcs.push_back({static_cast<int>(plate.holes.size()) + 1, 0, centre, false});
    plate.holes.push_back({centre + Point(0, radius)});
  }
  return plate;
}

/// Where one row of points between the sides of a band would do, or two, but for chance, most pieces of the
/// sides are cut once more: in contact they are what takes the memory.
TEST(NarrowPlaces, BetweenTheSidesOfABandAreCutForThoseAcross) {
  const double length = 1000, piece = length / 128;  // for the mesher halves
  for (const double share : {0.72, 0.8, 0.9, 0.95, 0.99})
    for (double width = 1; width < 7; width *= 1.04) {
      SCOPED_TRACE(std::to_string(width) + " sizes wide, pieces of " + std::to_string(share));
      const double size = piece / share, height = width * size;
      Polygon band{{{0, 0}, {length, 0}, {length, height}, {0, height}}, {}, {}};
      band.sides = {"bottom", "right", "top", "left"};
      expect_no_more(band, size, 1.07, 1.07);
    }
}

/// The chords that a polygon starts with leave much more room between arcs than these.
TEST(NarrowPlaces, BetweenArcsAreForeseen) {
  for (const double gap : {1e-1, 1e-2, 1e-4, 1e-6, 1e-7}) {
    SCOPED_TRACE(gap);
    for (const Polygon& polygon :
         {plate_with({{{-0.32, 0.02}, 0.3}, {{0.28 + gap, 0.02}, 0.3}}), plate_with({{{0, 0.3}, 0.7 - gap}}),
          plate_with({{{0, 0}, 0.5}, {{0.55 + gap, 0}, 0.05}})})
      expect_foreseen(polygon, MeshRequest(LargestEdge{5}), 0.8);
  }
}

/// Sides of unlike lengths are halved to unlike pieces, whose ends do not stand opposite: that takes more.
TEST(NarrowPlaces, BetweenSidesOfUnlikeLengthsAreCutABitMore) {
  expect_foreseen(beside(1e-4), MeshRequest(LargestEdge{1}), 0.7);
}

/// A long side is halved and halved again, so that its edges may be half as long as they may be.
TEST(NarrowPlaces, AreCutFinerByTheSize) {
  for (double size = 0.15; size < 4; size *= 1.2) {
    SCOPED_TRACE(size);
    expect_foreseen(strip(1000), MeshRequest(LargestEdge{size}));
  }
  for (const double size : {0.3, 0.1, 0.03}) {
    SCOPED_TRACE(size);
    expect_foreseen(wedge(0.02), MeshRequest(LargestEdge{size}));
  }
}

/// What counts of a disc with smaller triangles is the part in the domain.
TEST(NarrowPlaces, HaveLittleOfALocalSize) {
  MeshRequest request(LargestEdge{50});
  for (const double radius : {0., 5., 100.}) {
    SCOPED_TRACE(radius);
    request.sizes = {{{0, 0}, radius, 0.1}};
    expect_foreseen(strip(1000), request);
  }
}

TEST(Clusters, AreWhatLiesCloseTogetherAndFarFromTheRest) {
  const auto found = clusters(Rings(Polygon{{{0, 0}, {1, 0}, {10, 0}, {100, 0}, {10, 2}, {0, 1}}, {}, {}}));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].extent, 1);
  EXPECT_EQ(found[0].distance, 9);
  EXPECT_EQ(found[1].extent, 2);
  EXPECT_EQ(found[1].distance, 9);
  EXPECT_EQ(found[2].extent, 10);
  EXPECT_EQ(found[2].distance, 90);
  EXPECT_TRUE(clusters(Rings(Polygon{{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1.5, 1}}, {}, {}})).empty());
  // Not those on both sides of a slot, but its floor.
  const auto beside_a_slot = clusters(Rings(slit(1e-6)));
  EXPECT_EQ(std::ranges::count_if(beside_a_slot, [](const Cluster& own) { return own.extent < 0.1; }), 1);
  EXPECT_NEAR(beside_a_slot[0].extent, 1e-6, 1e-12);
  EXPECT_GT(beside_a_slot[0].distance, 0.3);
}

/// A disc with a circular hole that comes so close to its rim, in a direction.
Polygon with_hole_at_the_rim(double distance, double radius, double angle) {
  Polygon disc{{{1, 0}}, {}, {}};
  disc.arcs.push_back({0, 0, {0, 0}, false});
  const Point centre((1 - radius) * std::cos(angle), (1 - radius) * std::sin(angle));
  disc.holes.push_back({centre + Point(radius - distance, 0)});
  disc.arcs.push_back({1, 0, centre, false});
  return disc;
}

/// Found from outside: where chords of both circles were parallel, the domain was as narrow all along them,
/// and had twenty times the triangles that it has in other directions.
TEST(NarrowPlaces, BetweenCirclesAreCutAlikeInAllDirections) {
  for (const double distance : {1e-3, 1e-5}) {
    const double least = 2 * std::numbers::pi / std::sqrt(distance * (1 / 0.3 - 1) / 2);
    for (const double angle : {0., 0.3, std::numbers::pi / 4, 2.})
      EXPECT_LT(polygon_mesh(with_hole_at_the_rim(distance, 0.3, angle), 1).triangles.size(), 1.5 * least)
          << distance << " at " << angle;
  }
}

/// Found from outside: what is seen across what lies outside, ends that are narrow, and places that are
/// narrow in the middle of an edge.
TEST(NarrowPlaces, OfAllKindsAreForeseen) {
  for (const double e : {1e-2, 1e-4, 1e-6}) {
    const std::vector<Polygon> polygons{
        {{{0, 0}, {1, 0}, {1, 1}, {e, 1}, {0, 1 - e}}, {}, {}},                          // a corner cut off
        {{{0, 0}, {1, 0}, {1, 1}, {0.5 + e, 0.5}, {1, 2}, {0, 2}, {0.5, 0.5}}, {}, {}},  // a waist
        {{{0, 0}, {1, 0}, {1, 1}, {0.5 + e, 1}, {0.5, 0.3}, {0.5 - e, 1}, {0, 1}}, {}, {}},  // a notch
        {kSquare, {{{0.3, 0.4}, {0.3 + e, 0.4}, {0.3 + e, 0.6}, {0.3, 0.6}}}, {}},           // a slot
        {kSquare, {{{e, 0.5}, {0.2, 0.4}, {0.4, 0.5}, {0.2, 0.6}}}, {}},  // a vertex at the rim
        {kSquare,
         {{{0.1, 0.5}, {0.3, 0.4}, {0.5 - e, 0.5}, {0.3, 0.6}},
          {{0.5, 0.5}, {0.7, 0.4}, {0.9, 0.5}, {0.7, 0.6}}},
         {}},
        // a slot that ends close to the rim
        {{{0, 0}, {1, 0}, {1, 1}, {0.501, 1}, {0.501, e}, {0.5, e}, {0.5, 1}, {0, 1}}, {}, {}},
        slit(e)};
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const auto [foreseen, made] = foreseen_and_made(polygons[i], 3);
      EXPECT_LE(made.triangles, foreseen.triangles + 10) << i << " " << e;
      EXPECT_GE(12 * made.triangles + 100, foreseen.triangles) << i << " " << e;
      EXPECT_LE(5 * made.edges_of_parts(), 6 * foreseen.edges_of_parts() + 50) << i << " " << e;
    }
  }
}

TEST(NarrowPlaces, CornersAndSlitsNeedFewTriangles) {
  for (const double distance : {1e-2, 1e-5, 1e-8}) {
    EXPECT_LT(counted(pointed(distance)), 200);
    EXPECT_LT(counted(slit(distance)), 50);
    EXPECT_LT(polygon_mesh(pointed(distance), 0.25).triangles.size(), 1000u);
  }
}

TEST(NarrowPlaces, RefuseATooNarrowDomainAtOnceAndSayWhere) {
  for (const double scale : {1., 1e-9, 1e9})
    for (const auto& [polygon, pointer] :
         {std::pair(beside(1e-7), "/domain/vertices/0"), std::pair(wedge(1e-5), "/domain/vertices/0"),
          std::pair(strip(1e7), "/domain/vertices/0"), std::pair(zigzag(200, 1e-3), "/domain/vertices/0")}) {
      std::vector<Fault> faults;
      EXPECT_LT(seconds_of([&, &narrow = polygon] { faults = validate(scaled(narrow, scale)); }), 1);
      ASSERT_EQ(faults.size(), 1u);
      EXPECT_EQ(faults[0].where.substr(0, 17), std::string(pointer).substr(0, 17));
      EXPECT_NE(faults[0].detail.find("more than 300,000 triangles"), std::string::npos);
      EXPECT_NE(faults[0].detail.find("that begins at /domain/"), std::string::npos);
    }
  const std::vector<Fault> named = validate(beside(1e-7));
  EXPECT_EQ(named[0].where, "/domain/vertices/0");
  EXPECT_NE(named[0].detail.find("(0, 0) to (1, 0)"), std::string::npos);
  EXPECT_NE(named[0].detail.find("begins at /domain/holes/0/0"), std::string::npos);
}

TEST(NarrowPlaces, AreFoundSoonAmongManyEdges) {
  Polygon disc, comb;
  for (int i = 0; i < 50'000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 50'000;
    disc.vertices.push_back({std::cos(angle), std::sin(angle)});
  }
  comb = zigzag(20'000, 1e-6);
  double found = 0;
  EXPECT_LT(seconds_of([&] { found = counted(disc); }), 2);
  EXPECT_EQ(found, 0);
  EXPECT_LT(seconds_of([&] { found = counted(comb); }), 4);
  EXPECT_GT(found, 1e6);
}

/// A comb of teeth of random heights with slots between them.
Polygon uneven_teeth(int teeth, double slot, std::mt19937& random) {
  std::uniform_real_distribution<double> height(1.2, 2);
  Polygon comb{{{0, -0.1}, {teeth + (teeth - 1) * slot, -0.1}}, {}, {}};
  for (int tooth = teeth - 1; tooth >= 0; --tooth) {
    const double left = tooth * (1 + slot), top = height(random);
    comb.vertices.insert(comb.vertices.end(), {{left + 1, 0}, {left + 1, top}, {left, top}, {left, 0}});
  }
  comb.vertices.erase(comb.vertices.begin() + 2);
  comb.vertices.pop_back();
  return comb;
}

TEST(NarrowPlaces, OutsideTheDomainCutNothing) {
  std::mt19937 random(3);
  for (const double slot : {1e-2, 1e-4, 1e-7})
    for (const int teeth : {2, 7, 20}) {
      const Mesh mesh = polygon_mesh(uneven_teeth(teeth, slot, random), 0.5);
      // The floors of the slots are edges of the domain, from which triangles grow.
      EXPECT_LT(mesh.triangles.size(), (60 - 15 * std::log2(slot)) * teeth)
          << teeth << " teeth, slots of " << slot;
      EXPECT_EQ(misfiled_edges(mesh), 0);
      EXPECT_LE(longest_edge(mesh), 0.5 * (1 + 1e-8));
      EXPECT_GT(smallest_angle(mesh), 20);
    }
}

/// A star-shaped ring of a random shape, spiky at times.
std::vector<Point> random_ring(std::mt19937& random, int vertices, const Point& centre, double radius) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  const double inner = std::pow(10., between(-4, 0));
  std::vector<Point> ring;
  for (int i = 0; i < vertices; ++i) {
    const double angle = 2 * std::numbers::pi * (i + between(0, 0.9)) / vertices;
    const double r = radius * (random() % 2 == 0 ? 1 : between(inner, 1));
    ring.push_back(centre + r * Vector(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

TEST(NarrowPlaces, EveryRandomPolygonEndsSoon) {
  std::mt19937 random(11);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  int meshed = 0, refused = 0;
  for (int trial = 0; trial < 80; ++trial) {
    Polygon polygon;
    switch (trial % 4) {
      case 0:
        polygon = wedge(std::pow(10., between(-6, 1.7)));
        break;
      case 1:
        polygon = trial % 8 == 1 ? beside(std::pow(10., between(-8, -0.4)))
                                 : pointed(std::pow(10., between(-8, -1)));
        break;
      case 2:
        polygon = zigzag(2 + static_cast<int>(random() % 98), std::pow(10., between(-6, 0)));
        break;
      default:
        polygon.vertices = random_ring(random, 3 + static_cast<int>(random() % 198), {0, 0}, 1);
    }
    polygon = scaled(polygon, std::pow(10., between(-6, 6)));
    double extent = 0;
    for (const Point& x : polygon.vertices) extent = std::max(extent, x.cwiseAbs().maxCoeff());
    const double seconds = seconds_of([&] {
      try {
        const Mesh mesh = polygon_mesh(polygon, 0.3 * extent);
        EXPECT_LT(mesh.triangles.size(), 1e6) << trial;
        EXPECT_NEAR(mesh.area(), area(polygon), 1e-9 * extent * extent) << trial;
        EXPECT_GT(smallest_angle(mesh), 0) << trial;
        ++meshed;
      } catch (const InvalidProblem& invalid) {
        EXPECT_EQ(invalid.faults()[0].where.substr(0, 7), "/domain") << invalid.what();
        EXPECT_FALSE(invalid.faults()[0].detail.empty());
        ++refused;
      }
    });
    EXPECT_LT(seconds, 30) << trial;
  }
  std::printf("random polygons: %d meshed, %d refused\n", meshed, refused);
  EXPECT_GT(meshed, 40);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace signorini::narrow_places_test
