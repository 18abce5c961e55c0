// Where the pairs for elasticity are stable, and what is done where they are not.
#include "fem/stability.hpp"

#include <gtest/gtest.h>

#include <random>

#include <Eigen/Eigenvalues>

#include "fem/rigid_frame.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh_quality.hpp"
#include "problems/elasticity.hpp"
#include "system/hybrid_system.hpp"

namespace signorini::stability_test {
namespace {

constexpr std::array kSchemes{Scheme::nonconforming, Scheme::conforming};

Problem elastic(Scheme scheme) {
  Problem problem;
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  return problem;
}

/// The least eigenvalues of K, scaled to a diagonal of ones.
Eigen::VectorXd spectrum(const Problem& problem, const Mesh& mesh) {
  Observer indifferent;
  Progress progress(indifferent, {});
  const ElementSum sum = assemble(Discretization(problem, mesh), progress).matrix;
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(sum.size, sum.size);
  for (int e = 0; e < sum.elements(); ++e)
    for (int j = 0; j < sum.per_element; ++j)
      for (int i = 0; i < sum.per_element; ++i)
        if (sum.unknowns_of(e)[i] >= 0 && sum.unknowns_of(e)[j] >= 0)
          k(sum.unknowns_of(e)[i], sum.unknowns_of(e)[j]) += sum.matrix(e)[i + sum.per_element * j];
  const Eigen::VectorXd scale = k.diagonal().cwiseSqrt().cwiseInverse();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * k * scale.asDiagonal())
      .eigenvalues();
}

int kernel(const Problem& problem, const Mesh& mesh) {
  return static_cast<int>((spectrum(problem, mesh).array() < 1e-10).count());
}

/// The rigid motions that fixed parts and rollers leave free.
int free_motions(const Problem& problem, const Mesh& mesh) {
  const RigidFrame frame(2, {0, 0}, 1);
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
  const auto add = [&](const Eigen::RowVector3d& r) { held += r.transpose() * r; };
  for (const BoundaryPart& part : mesh.boundary)
    for (const int edge : part.edges)
      for (const int point : mesh.edges[edge]) {
        if (condition_on<Roller>(problem, part.name))
          add(frame.along(mesh.outward_normal(edge), mesh.points[point]));
        if (condition_on<Fixed>(problem, part.name))
          for (int c = 0; c < 2; ++c) add(frame.component(c, mesh.points[point]));
      }
  return static_cast<int>(
      (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(held).eigenvalues().array() < 1e-9).count());
}

/// Triangles joined at random edges, and a part of its own for each edge of the boundary.
Mesh random_mesh(int triangles, std::mt19937& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  std::vector<Point> points{{0, 0}, {1, 0}, {between(0.2, 0.8), between(0.4, 1)}};
  std::vector<std::array<int, 3>> all{{0, 1, 2}};
  std::vector<std::array<int, 2>> boundary{{0, 1}, {1, 2}, {2, 0}};
  while (static_cast<int>(all.size()) < triangles) {
    const auto at = boundary.begin() + static_cast<int>(random() % boundary.size());
    const auto [a, b] = *at;
    const Vector way = points[b] - points[a];
    points.push_back(points[a] + between(0.3, 0.7) * way + between(0.4, 0.9) * Vector(way.y(), -way.x()));
    const int c = static_cast<int>(points.size()) - 1;
    all.push_back({b, a, c});
    boundary.erase(at);
    boundary.insert(boundary.end(), {{a, c}, {c, b}});
  }
  std::vector<std::string> names;
  std::vector<BoundarySegment> segments;
  for (int i = 0; i < static_cast<int>(boundary.size()); ++i) {
    names.push_back("part" + std::to_string(i));
    segments.push_back({boundary[i], i});
  }
  return make_mesh(std::move(points), std::move(all), names, segments);
}

/// A strip one square high and `aspect` squares long, of a length and a modulus of any size.
Problem strip(Scheme scheme, int aspect, Pattern pattern, double scale) {
  Problem problem = elastic(scheme);
  problem.domain = Rectangle{{0, 0}, {scale * aspect, scale}};
  problem.mesh = {Divisions{aspect, 1}, pattern};
  problem.boundary = {{"left", Fixed{}}};
  return problem;
}

Mesh requested(const Problem& problem) {
  return make_domain_mesh(problem.domain, problem.mesh);
}

TEST(Stability, ARefinedMeshHasNoKernelButRigidMotions) {
  std::mt19937 random(3);
  int unstable = 0;
  for (int trial = 0; trial < 600; ++trial)
    for (const Scheme scheme : kSchemes) {
      Problem problem = elastic(scheme);
      const Mesh mesh = random_mesh(1 + trial % 6, random);
      const std::array<Condition, 6> conditions{Fixed{},    Roller{},   Contact{},
                                                Traction{}, Traction{}, Traction{}};
      for (const BoundaryPart& part : mesh.boundary) problem.boundary[part.name] = conditions[random() % 6];
      const int rigid = free_motions(problem, mesh);
      const Mesh stable = stabilized(problem, mesh);
      EXPECT_EQ(kernel(problem, stable), rigid) << "trial " << trial;
      const bool was_stable = kernel(problem, mesh) == rigid;
      unstable += !was_stable;
      EXPECT_TRUE(was_stable || stable.notes.size() == 1) << "trial " << trial;
      if (scheme == Scheme::conforming && mesh.triangles.size() > 1) {
        EXPECT_EQ(stable.notes.empty(), was_stable) << "trial " << trial;
      }
    }
  EXPECT_GT(unstable, 100);
}

TEST(Stability, AStripHeldByOneEdgeIsRefinedThere) {
  for (const int aspect : {1, 4, 20, 120, 400})
    for (const Pattern pattern : {Pattern::right, Pattern::alternating, Pattern::crossed})
      for (const double scale : {1e-9, 1., 1e9}) {
        const Problem problem = strip(Scheme::nonconforming, aspect, pattern, scale);
        const Mesh mesh = requested(problem), stable = stabilized(problem, mesh);
        ASSERT_EQ(stable.notes.size(), 1u) << aspect;
        EXPECT_LE(stable.triangles.size(), mesh.triangles.size() + 8);
        EXPECT_EQ(stable.boundary[0].edges.size(), 2u);
        EXPECT_GT(smallest_angle(stable), smallest_angle(mesh) / 2 - 1e-9);
        EXPECT_TRUE(stabilized(problem, stable).notes == stable.notes) << "once is enough";
        if (aspect <= 20) {
          EXPECT_EQ(kernel(problem, mesh), 1);
          EXPECT_EQ(kernel(problem, stable), 0);
        }
      }
}

TEST(Stability, SoundMeshesAreLeftAlone) {
  std::vector<Problem> sound;
  for (const Scheme scheme : kSchemes) {
    for (const Pattern pattern : {Pattern::right, Pattern::left, Pattern::alternating, Pattern::crossed}) {
      Problem problem = strip(scheme, 30, pattern, 1);
      problem.boundary = {{"left", Fixed{}}, {"right", Fixed{}}};  // one edge each, but far from each other
      sound.push_back(problem);
      problem.boundary = {{"bottom", Fixed{}}};
      sound.push_back(problem);
      problem.boundary = {{"left", Roller{}}, {"bottom", Contact{}}, {"top", Contact{}}};
      problem.mesh.fineness = Divisions{4, 2};
      sound.push_back(problem);
      sound.push_back(problems::pressed_block(scheme, pattern, 0.3, 1));
      sound.push_back(problems::lowered_block(scheme, pattern, 0.3, 0.1, 0.2));
    }
    sound.push_back(problems::pressed_angle(scheme));
    sound.push_back(problems::half_disc(scheme));
    sound.push_back(problems::Smooth(0.3).problem(scheme, 1));
    Problem sharp = elastic(scheme);  // a wedge that is held at its tip's sides
    sharp.domain = Polygon{{{0, 0}, {3, 0}, {3, 0.4}}, {}, {}};
    sharp.mesh.fineness = LargestEdge{0.5};
    sharp.boundary = {{"side0", Fixed{}}};
    sound.push_back(sharp);
    Problem round = elastic(scheme);  // rollers around a hole, held against turning elsewhere
    round.domain =
        Polygon{{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, {{{0.5, 0}, {0, 0.5}, {-0.5, 0}, {0, -0.5}}}, {}};
    round.mesh.fineness = LargestEdge{1};
    round.boundary = {{"hole0", Roller{}}, {"side0", Roller{}}};
    sound.push_back(round);
  }
  for (std::size_t i = 0; i < sound.size(); ++i) {
    const Mesh mesh = requested(sound[i]), same = stabilized(sound[i], mesh);
    EXPECT_TRUE(same.notes.empty()) << i;
    EXPECT_EQ(same.points, mesh.points) << i;
    EXPECT_EQ(same.triangles, mesh.triangles) << i;
  }
}

TEST(Stability, ASupportOfAFewUnevenEdgesIsRefined) {
  Problem problem = elastic(Scheme::nonconforming);
  problem.domain = MeshData{{{0, 0}, {2, 0}, {2, 1}, {0, 1}, {0, 0.01}},
                            {{0, 1, 4}, {4, 1, 2}, {4, 2, 3}},
                            {{"left", {{3, 4}, {4, 0}}}, {"rest", {{0, 1}, {1, 2}, {2, 3}}}}};
  problem.boundary = {{"left", Fixed{}}};
  const Mesh mesh = requested(problem), stable = stabilized(problem, mesh);
  EXPECT_EQ(stable.boundary[0].edges.size(), 4u);
  EXPECT_GT(spectrum(problem, stable)[0], 3 * spectrum(problem, mesh)[0]);
}

TEST(Stability, RollersAroundACircleThatTheMidpointsDoNotSee) {
  // Every normal of a regular polygon meets its centre from the middle of the edge.
  for (const int edges : {6, 48}) {
    Problem problem = elastic(Scheme::nonconforming);
    Polygon disc;
    for (int i = 0; i < edges; ++i) {
      const double angle = 2 * std::numbers::pi * i / edges;
      disc.vertices.push_back({std::cos(angle), std::sin(angle)});
      disc.sides.push_back("rim");
    }
    problem.domain = disc;
    problem.mesh.fineness = LargestEdge{1};
    problem.boundary = {{"rim", Roller{}}};
    const Mesh mesh = requested(problem);
    ASSERT_EQ(static_cast<int>(mesh.boundary[0].edges.size()), edges);
    EXPECT_EQ(kernel(problem, mesh), 1);
    EXPECT_EQ(kernel(problem, stabilized(problem, mesh)), 0);
  }
}

TEST(Stability, EverySmallBodyOfAMeshIsRefinedAndNoOther) {
  Problem problem = elastic(Scheme::conforming);
  problem.domain =
      MeshData{{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {3, 0}, {3, 1}, {2, 1}, {2.5, 0.5}},
               {{0, 1, 2}, {0, 2, 3}, {4, 5, 8}, {5, 6, 8}, {6, 7, 8}, {7, 4, 8}},
               {{"floor", {{0, 1}, {4, 5}}}, {"rest", {{1, 2}, {2, 3}, {3, 0}, {5, 6}, {6, 7}, {7, 4}}}}};
  problem.boundary = {{"floor", Contact{}}};
  const Mesh stable = stabilized(problem, requested(problem));
  EXPECT_EQ(stable.notes.size(), 1u);
  EXPECT_EQ(stable.triangles.size(), 8u + 4u);
  problem.boundary = {{"floor", Fixed{}}};
  EXPECT_TRUE(stabilized(problem, requested(problem)).notes.empty());
}

TEST(Stability, TheStripOfTheKernelBends) {
  // Under its own weight a clamped strip stores b² L⁵ / (40 E' I) = 3 b² L⁵ (1 − ν²) / (10 E h³) for slender
  // ones; the energy at the minimum is the negative of it.
  Problem problem = strip(Scheme::nonconforming, 120, Pattern::crossed, 1);
  problem.domain = Rectangle{{0, 0}, {50, 1}};
  constexpr double weight = 1e-9;
  problem.body = VectorField(Field(0), Field(-weight));
  const double slender = -0.3 * weight * weight * std::pow(50., 5) * (1 - 0.09);
  const Solution coarse = solve(problem, {ActiveSet{}, {}});
  ASSERT_EQ(coarse.summary.notes.size(), 2u);
  EXPECT_LT(coarse.summary.energy, slender);
  EXPECT_GT(coarse.summary.energy, 20 * slender);
  EXPECT_LT(coarse.summary.error_bound->energy_lower, slender);
  EXPECT_GT(coarse.summary.error_bound->energy_upper, slender);
  problem.mesh.fineness = Divisions{200, 4};
  const Solution fine = solve(problem, {ActiveSet{}, {}});
  EXPECT_TRUE(fine.summary.notes.empty());
  EXPECT_NEAR(fine.summary.energy, slender, 0.2 * std::abs(slender));
}

TEST(WorthNothing, ABoundAboveOneIsSaid) {
  Problem problem = strip(Scheme::nonconforming, 60, Pattern::crossed, 1);
  problem.body = VectorField(Field(0), Field(-1e-9));
  const Summary slender = solve(problem, {ActiveSet{}, {}}).summary;
  ASSERT_GT(slender.error_bound->relative, 1);
  EXPECT_NE(slender.notes.back().find("worth nothing; take a finer mesh"), std::string::npos);
  EXPECT_NE(slender.notes.back().find("conforming scheme"), std::string::npos);

  problem.scheme = Scheme::conforming;
  const Summary better = solve(problem, {ActiveSet{}, {}}).summary;
  ASSERT_LE(better.error_bound->relative, 1);
  EXPECT_TRUE(better.notes.empty());
}

TEST(WorthNothing, AStressThatIsZeroIsNoReason) {
  for (const Scheme scheme : kSchemes) {
    Problem moved = problems::block(scheme, Pattern::crossed, 3, 0.3);
    moved.boundary = {{"left", Fixed{VectorField(0.1, 0.2)}}};
    const Problem open = problems::lowered_block(scheme, Pattern::right, 0.3, 0.3, 0.1);
    for (const Problem& problem : {moved, open})
      for (const std::string& note : solve(problem, {ActiveSet{}, {}}).summary.notes)
        EXPECT_TRUE(note.starts_with("the body has no stress but rounding")) << note;
  }
}

}  // namespace
}  // namespace signorini::stability_test
