// Bodies whose boundary has arcs: meshes that follow them, data read on them, the pressure of contact on
// them.
#include "mesh/arc.hpp"

#include <random>

#include <gtest/gtest.h>

#include "mesh/bisect.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/polygon.hpp"
#include "mesh/refine.hpp"
#include "mesh_quality.hpp"
#include "problems/elasticity.hpp"

namespace signorini::arc_test {
namespace {

using std::numbers::pi;

/// The lower half of a disc of radius 1 about (0, 1).
Polygon half_disc() {
  return {{{-1, 1}, {1, 1}}, {}, {"arc", "top"}, {{0, 0, {0, 1}}}};
}

/// A square with a circular hole, one whose boundary is a long arc and a chord, and a notch.
Polygon perforated() {
  Polygon polygon{{{0, 0}, {4, 0}, {4, 1}, {4, 2}, {4, 4}, {0, 4}}, {{{1.5, 1}}, {{3, 3}, {3, 2.6}}}, {}};
  polygon.arcs = {{0, 2, {4, 1.5}, true}, {1, 0, {1, 1}}, {2, 0, {2.8, 2.8}, true}};
  return polygon;
}

/// Two circles that are not about the same point, 0.01 apart at their closest.
Polygon thin_ring() {
  return {{{1, 0}}, {{{0.99, 0}}}, {}, {{0, 0, {0, 0}}, {1, 0, {0.005, 0}}}};
}

Polygon scaled(Polygon polygon, double factor) {
  for (Point& x : polygon.vertices) x *= factor;
  for (auto& hole : polygon.holes)
    for (Point& x : hole) x *= factor;
  for (Arc& arc : polygon.arcs) arc.centre *= factor;
  return polygon;
}

/// How far the ends of chords are from their circles, beside the radius.
double farthest_from_arcs(const Mesh& mesh) {
  double farthest = 0;
  for (const BoundaryPart& part : mesh.boundary)
    for (const int edge : part.edges) {
      if (mesh.circle_of(edge) < 0) continue;
      const Circle& circle = mesh.circles[mesh.circle_of(edge)];
      for (const int point : mesh.edges[edge])
        farthest = std::max(
            farthest, std::abs((mesh.points[point] - circle.centre).norm() - circle.radius) / circle.radius);
    }
  return farthest;
}

constexpr double kRounding = 1e-14;

double area_of_half_disc = pi / 2;
/// Of the notch a half circle; the second hole's chord is 0.2 √2 away from the corner between its radii.
double area_of_perforated = 16 - pi / 8 - pi / 4 - (0.08 * (3 * pi / 2) / 2 + 0.04);

TEST(Arcs, AreFollowedByTheMeshWhateverTheUnits) {
  for (const double factor : {1.0, 1e9, 1e-9})
    for (const Polygon& polygon : {half_disc(), perforated(), thin_ring()}) {
      const Mesh mesh =
          polygon_mesh(scaled(polygon, factor), 0.5 * factor, {{Point(0, 0), 0.2 * factor, 0.01 * factor}});
      EXPECT_LT(farthest_from_arcs(mesh), kRounding);
      EXPECT_EQ(misfiled_edges(mesh), 0);
      EXPECT_GT(smallest_angle(mesh), 10);
      EXPECT_EQ(names_of(mesh), part_names(polygon));
      EXPECT_EQ(mesh.triangles, polygon_mesh(polygon, 0.5, {{Point(0, 0), 0.2, 0.01}}).triangles);
      for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge)
        if (mesh.circle_of(edge) >= 0) {
          EXPECT_LE(mesh.length(edge),
                    2 * std::sin(pi / 16) * mesh.circles[mesh.circle_of(edge)].radius * (1 + 1e-9));
        }
    }
}

/// Area and length of chords are wrong by their number to the power −2.
TEST(Arcs, OfFinerMeshesHaveTheirAreaAndLength) {
  const Mesh disc = polygon_mesh(half_disc(), 0.01), square = polygon_mesh(perforated(), 0.02);
  EXPECT_NEAR(disc.area(), area_of_half_disc, 1e-4);
  EXPECT_NEAR(square.area(), area_of_perforated, 1e-3);
  EXPECT_NEAR(length_of(disc, part_of(disc, "arc")), pi, 1e-4);
  EXPECT_NEAR(length_of(square, part_of(square, "hole0")), pi, 1e-3);
  EXPECT_NEAR(length_of(square, part_of(square, "side2")), pi / 2, 1e-3);
  EXPECT_NEAR(length_of(square, part_of(square, "hole1")), 0.2 * std::sqrt(2) * 3 * pi / 2 + 0.4, 1e-3);
}

TEST(Arcs, KeepNewPointsOfRefinement) {
  for (const double factor : {1.0, 1e9, 1e-9})
    for (const Polygon& polygon : {half_disc(), perforated(), thin_ring()}) {
      const Mesh coarse = polygon_mesh(scaled(polygon, factor), factor);
      const Mesh fine = refine(coarse, 2);
      EXPECT_LT(farthest_from_arcs(fine), kRounding);
      EXPECT_GT(smallest_angle(fine), 10);
      EXPECT_EQ(misfiled_edges(fine), 0);

      std::mt19937 engine(7);
      Mesh mesh = with_longest_edges_first(coarse);
      for (int round = 0; round < 8; ++round) {
        std::vector<int> marked;
        for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
          if (engine() % 4 == 0) marked.push_back(t);
        mesh = bisect(mesh, marked);
        ASSERT_LT(farthest_from_arcs(mesh), kRounding);
        ASSERT_GT(smallest_angle(mesh), 5);
        ASSERT_EQ(misfiled_edges(mesh), 0);
      }
    }
}

/// A triangle's children are its own where a pair on a finer mesh of the same body is made of them.
TEST(Arcs, StayChordsWhereTheBodyMustNotChange) {
  const Mesh mesh = with_longest_edges_first(polygon_mesh(half_disc(), 0.5));
  std::vector<int> all(mesh.triangles.size()), parents;
  std::iota(all.begin(), all.end(), 0);
  EXPECT_NEAR(bisect(mesh, all, parents).area(), mesh.area(), 1e-14);
  EXPECT_GT(bisect(mesh, all).area(), mesh.area() * (1 + 1e-4));
}

TEST(Arcs, AreWhereBoundaryDataAreRead) {
  for (const double factor : {1.0, 1e9, 1e-9}) {
    const Mesh mesh = polygon_mesh(scaled(perforated(), factor), factor);
    for (const BoundaryPart& part : mesh.boundary)
      for (const int edge : part.edges)
        for (const double s : {0.0, 0.3, 0.5, 1.0}) {
          const auto [x, normal] = mesh.on_boundary(edge, s);
          const auto& [a, b] = mesh.edges[edge];
          const Point chord = (1 - s) * mesh.points[a] + s * mesh.points[b];
          EXPECT_GT(normal.dot(mesh.outward_normal(edge)), std::cos(pi / 16) - 1e-9);
          if (mesh.circle_of(edge) < 0) {
            EXPECT_LT((x - chord).norm(), 1e-14 * factor);
            continue;
          }
          const Circle& circle = mesh.circles[mesh.circle_of(edge)];
          EXPECT_NEAR((x - circle.centre).norm() / circle.radius, 1, kRounding);
          EXPECT_NEAR(std::abs(normal.dot(x - circle.centre)) / circle.radius, 1, kRounding);
        }
  }
}

std::string faults_of(const Polygon& polygon) {
  std::string text;
  for (const Fault& fault : validate(polygon)) text += fault.where + " " + fault.detail + "\n";
  return text;
}

TEST(Arcs, FaultsAreAllNamed) {
  EXPECT_EQ(faults_of(half_disc()) + faults_of(perforated()) + faults_of(thin_ring()), "");
  const std::vector<Point> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  struct Case {
    Polygon polygon;
    std::string where, word;
  };
  const std::vector<Case> cases{
      {{square, {}, {}, {{0, 1, {0.5, 0.6}}}}, "/domain/vertices/1/arc/centre", "(0.5, 0.5)"},
      {{square, {}, {}, {{0, 1, {1, 1}}}}, "/domain/vertices/1/arc/centre", "radius is zero"},
      {{square, {}, {}, {{0, 3, {1e9, 0.5}}}}, "/domain/vertices/3/arc/centre", "straight"},
      {{square, {}, {}, {{0, 3, {0, std::nan("")}}}}, "/domain/vertices/3/arc/centre", "finite"},
      {{square, {{{0.5, 0.5}, {0.6, 0.5}}}, {}, {{1, 1, {0.5, 0.6}}}},
       "/domain/holes/0/1/arc/centre",
       "must be"},
      // A half circle that runs counter-clockwise from (1, 0) to (1, 1) stays outside; the other one crosses
      // a hole.
      {{square, {{{0.4, 0.4}, {0.8, 0.5}, {0.4, 0.6}}}, {}, {{0, 1, {1, 0.5}, true}}},
       "/domain/vertices/1",
       "the arc from (1, 0) to (1, 1)"},
      {{square, {{{1.1, 0.5}}}, {}, {{1, 0, {0.5, 0.5}}}},
       "/domain/vertices/",
       "the circle about (0.5, 0.5)"},
      {{square, {{{0.5 + 1e-11, 0.5}}}, {}, {{1, 0, {0.5, 0.5}}}}, "/domain/holes/0", "so small"},
      {{square, {{{3.1, 0.5}}}, {}, {{1, 0, {3, 0.5}}}}, "/domain/holes/0", "inside the outer ring"},
  };
  for (const Case& bad : cases)
    for (const double factor : {1.0, 1e9, 1e-9}) {
      const std::string faults = faults_of(scaled(bad.polygon, factor));
      EXPECT_NE(faults.find(bad.where), std::string::npos) << bad.where << " not in: " << faults;
      const bool has_word = factor != 1 || faults.find(bad.word) != std::string::npos;
      EXPECT_TRUE(has_word) << bad.word << " not in: " << faults;
      EXPECT_THROW(polygon_mesh(scaled(bad.polygon, factor), factor), InvalidProblem);
    }
}

/// A tube around a rigid pin of the same radius, moved by 1 % of it: half of the hole touches, along its
/// normals.
Problem pinned_tube(Scheme scheme, double size, double length = 1, double modulus = 1) {
  Polygon tube{{{2 * length, 0}}, {{{length, 0}}}, {"outer"}, {{0, 0, {0, 0}}, {1, 0, {0, 0}}}};
  Problem problem;
  problem.domain = tube;
  problem.mesh.fineness = LargestEdge{size * length};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(modulus), Field(0.3), Plane::strain};
  problem.boundary = {{"outer", Fixed{VectorField(0.01 * length, 0)}}, {"hole0", Contact{}}};
  return problem;
}

/// The body slides along the pin, which chords hold up at their ends. The peak of a polygon with the same
/// vertices, and of rows that keep to their own chord, stays 8 % too high however fine the mesh.
TEST(Arcs, ThePeakOfContactAlongTheNormalsConverges) {
  constexpr double peak = 0.01670;  // of the nonconforming scheme, extrapolated
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Summary summary = solve(pinned_tube(scheme, 0.1), {ActiveSet{}, {}}).summary;
    EXPECT_NEAR(summary.contact.max_pressure / peak, 1, 0.01);
    EXPECT_NEAR(summary.contact.force / 0.0333, 1, 0.005);
  }
}

TEST(Arcs, AContactOnThemIsTheSameInOtherUnits) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Summary one = solve(pinned_tube(scheme, 0.5), {ActiveSet{}, {}}).summary;
    for (const auto& [length, modulus] : {std::pair(1e9, 1e-9), std::pair(1e-9, 1e9)}) {
      const Summary same = solve(pinned_tube(scheme, 0.5, length, modulus), {ActiveSet{}, {}}).summary;
      EXPECT_EQ(same.triangles, one.triangles);
      EXPECT_NEAR(same.contact.max_pressure / modulus / one.contact.max_pressure, 1, 1e-9);
      EXPECT_NEAR(same.contact.length / length / one.contact.length, 1, 1e-9);
      ASSERT_TRUE(same.error_bound && one.error_bound);
      EXPECT_NEAR(same.error_bound->relative / one.error_bound->relative, 1, 1e-6);
      EXPECT_EQ(same.error_bound->guaranteed, one.error_bound->guaranteed);
    }
  }
}

bool says(const Summary& summary, const std::string& words) {
  return std::ranges::any_of(summary.notes,
                             [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(Arcs, NotesSayWhatThePeakAndTheBoundMean) {
  constexpr const char *infinite = "true pressure of this polygon is infinite",
                       *bound = "with chords for its arcs";
  const Settings settings{ActiveSet{}, {}};
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem polygon = problems::half_disc(scheme);
    const Summary bent = solve(polygon, settings).summary;
    EXPECT_TRUE(says(bent, infinite));
    EXPECT_TRUE(says(bent, "the contact arc bends"));
    EXPECT_FALSE(says(bent, bound));
    std::get<Contact>(polygon.boundary.at("arc")).direction = {0, -1};
    EXPECT_FALSE(says(solve(polygon, settings).summary, infinite));
    const Summary round = solve(pinned_tube(scheme, 0.5), settings).summary;
    EXPECT_FALSE(says(round, infinite));
    EXPECT_TRUE(says(round, bound));
    // Square corners do no harm.
    EXPECT_TRUE(
        solve(problems::pressed_block(scheme, Pattern::crossed, 0.3, 0.01), settings).summary.notes.empty());
  }
}

}  // namespace
}  // namespace signorini::arc_test
