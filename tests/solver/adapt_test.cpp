#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "certify/mark.hpp"
#include "mesh_quality.hpp"
#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"

namespace signorini::adapt_test {
namespace {

constexpr std::array schemes{Scheme::conforming, Scheme::nonconforming};

Problem adaptive(Problem problem, double tolerance, int max_triangles) {
  problem.mesh.adaptive = Adaptive{tolerance, max_triangles};
  return problem;
}

Settings by(Method method) {
  return {method, std::nullopt};
}

/// The slope of log(bound) over log(triangles) by least squares, from the first level with so many triangles.
double rate(const std::vector<Level>& levels, int from) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Level& level : levels) {
    if (level.triangles < from) continue;
    const double size = std::log(static_cast<double>(level.triangles)), bound = std::log(level.bound);
    n += 1, x += size, y += bound, xx += size * size, xy += size * bound;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// The problem on the mesh that another solve ended with.
Problem on_mesh(Problem problem, const Mesh& mesh) {
  MeshData data{mesh.points, mesh.triangles, {}};
  for (const BoundaryPart& part : mesh.boundary) {
    data.boundary.emplace_back(part.name, std::vector<std::array<int, 2>>{});
    for (const int edge : part.edges) data.boundary.back().second.push_back(mesh.edges[edge]);
  }
  problem.domain = data;
  problem.mesh = {};
  return problem;
}

/// Where the contact is open.
std::set<std::pair<double, double>> open_places(const Solution& solution) {
  std::set<std::pair<double, double>> places;
  for (const ContactPart& part : solution.contact)
    for (std::size_t i = 0; i < part.points.size(); ++i)
      if (part.open[i]) places.insert({part.points[i].x(), part.points[i].y()});
  return places;
}

/// Ends a solve once it has had so many levels.
class UntilLevel : public Observer {
 public:
  explicit UntilLevel(int last) : last_(last) {}
  void refined(const Level& level, const Solution&) override { reached_ = level.number; }
  bool keep_going() override { return reached_ < last_; }

 private:
  int last_, reached_ = 0;
};

TEST(Mark, TakesTheFewestTrianglesThatMakeUpHalf) {
  const Eigen::VectorXd squares{{1, 4, 0.5, 2, 0.5}};
  EXPECT_EQ(mark(squares), std::vector<int>{1});
  EXPECT_EQ(mark(squares, 0.75), (std::vector<int>{1, 3}));
  EXPECT_EQ(mark(squares, 1).size(), 5u);
  EXPECT_TRUE(mark(Eigen::VectorXd::Zero(3)).empty());
}

TEST(Adapt, HasTheBestRateInTheNumberOfTriangles) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Scheme scheme : schemes) {
    const bool conforming = scheme == Scheme::conforming;
    for (const Problem& problem : {problems::paper(scheme, 4), problems::SignoriniEdge::problem(scheme, 4)}) {
      const Solution solution = solve(adaptive(problem, 1e-9, conforming ? 8000 : 20000), by(ActiveSet{}));
      EXPECT_LE(rate(solution.summary.levels, 300), conforming ? -0.95 : -0.48);
    }
  }
}

TEST(Adapt, HasTheBestRateForElasticBodies) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Scheme scheme : schemes) {
    const bool conforming = scheme == Scheme::conforming;
    const Solution solution =
        solve(adaptive(problems::pressed_angle(scheme), 1e-9, conforming ? 15000 : 6000), by(ActiveSet{}));
    EXPECT_LE(rate(solution.summary.levels, 300), conforming ? -0.95 : -0.48);
    EXPECT_TRUE(solution.summary.error_bound.value().guaranteed);
  }
}

TEST(Adapt, HasTheBestRateForTheHalfDisc) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  const Solution solution =
      solve(adaptive(problems::half_disc(Scheme::nonconforming), 1e-9, 8000), by(ActiveSet{}));
  EXPECT_LE(rate(solution.summary.levels, 300), -0.48);
  EXPECT_TRUE(solution.summary.error_bound.value().guaranteed);
}

TEST(Adapt, HasABetterRateThanUniformRefinement) {
  std::vector<Level> uniform;
  for (const int n : {8, 16, 32}) {
    const Summary summary =
        solve(problems::SignoriniEdge::problem(Scheme::conforming, n), by(ActiveSet{})).summary;
    uniform.push_back(
        {1, static_cast<int>(summary.triangles), 0, summary.error_bound.value().value, 0, 0, 0});
  }
  EXPECT_NEAR(rate(uniform, 0), -0.75, 0.03);
}

TEST(Adapt, SolvesThePapersProblemToOneThousandth) {
  const Solution solution =
      solve(adaptive(problems::paper(Scheme::conforming, 4), 1e-3, 10000), by(ActiveSet{}));
  const ErrorBound& bound = solution.summary.error_bound.value();
  EXPECT_EQ(solution.summary.outcome, Outcome::converged) << solution.summary.advice;
  EXPECT_LE(bound.relative, 1e-3);
  EXPECT_TRUE(bound.guaranteed);
  constexpr double energy = -0.914792950798;
  EXPECT_LE(bound.energy_lower, energy);
  EXPECT_GE(bound.energy_upper, energy);
  EXPECT_EQ(solution.summary.levels.back().triangles, solution.summary.triangles);
  EXPECT_EQ(solution.summary.triangles, static_cast<std::int64_t>(solution.mesh->triangles.size()));
}

TEST(Adapt, IsTheSolutionOfItsLastMesh) {
  for (const Scheme scheme : schemes)
    for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{1e-12}}}) {
      const Problem problem = problems::paper(scheme, 4);
      const Solution grown = solve(adaptive(problem, 0.05, 20000), by(method));
      const Solution fresh = solve(on_mesh(problem, *grown.mesh), by(method));
      EXPECT_NEAR(grown.summary.energy, fresh.summary.energy, 1e-9);
      EXPECT_EQ(open_places(grown), open_places(fresh));
      // The start of the last level is worth something.
      EXPECT_LE(grown.summary.levels.back().iterations, fresh.summary.iterations);
    }
}

TEST(Adapt, StartsTheActiveSetFromTheCoarserLevel) {
  const Solution solution =
      solve(adaptive(problems::paper(Scheme::nonconforming, 8), 0.03, 100000), by(ActiveSet{}));
  int most = 0;
  for (const Level& level : solution.summary.levels)
    if (level.number > 3) most = std::max(most, level.iterations);
  EXPECT_LE(most, 2);
}

TEST(Adapt, NumbersItsIterationsThroughAllLevels) {
  const Solution solution = solve(adaptive(problems::paper(Scheme::nonconforming, 4), 0.1, 100000));
  int iterations = 0;
  for (const Level& level : solution.summary.levels) iterations += level.iterations;
  ASSERT_EQ(solution.history.size(), static_cast<std::size_t>(iterations));
  EXPECT_EQ(solution.summary.iterations, iterations);
  for (int i = 0; i < iterations; ++i) EXPECT_EQ(solution.history[i].number, i + 1);
}

TEST(Adapt, RefinesPolygonsAndGivenMeshes) {
  for (const Scheme scheme : schemes) {
    Problem problem = problems::paper(scheme, 2);
    problem.domain = Polygon{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                             {{{0.3, 0.3}, {0.7, 0.3}, {0.5, 0.7}}},
                             {"floor", "right", "step", "step", "top", "left"}};
    problem.mesh = MeshRequest(LargestEdge{0.6});
    problem.body = VectorField(-1);
    problem.boundary = {
        {"right", Fixed{}}, {"top", Fixed{}}, {"floor", Contact{0.05}}, {"hole0", Contact{0.1}}};
    const Solution polygon = solve(adaptive(problem, 0.08, 50000), by(ActiveSet{}));
    EXPECT_EQ(polygon.summary.outcome, Outcome::converged) << polygon.summary.advice;
    EXPECT_EQ(misfiled_edges(*polygon.mesh), 0);
    const double coarse = solve(problem, by(ActiveSet{})).mesh->area();
    EXPECT_NEAR(polygon.mesh->area(), coarse, 1e-12);

    const Problem given = on_mesh(problem, *solve(problem, by(ActiveSet{})).mesh);
    const Solution same = solve(adaptive(given, 0.08, 50000), by(ActiveSet{}));
    EXPECT_EQ(same.summary.outcome, Outcome::converged) << same.summary.advice;
    EXPECT_NEAR(same.summary.energy, polygon.summary.energy, 0.01 * std::abs(polygon.summary.energy));
  }
}

TEST(Adapt, EndsAtItsCapWithTheBestMeshSoFar) {
  const Solution solution =
      solve(adaptive(problems::paper(Scheme::nonconforming, 4), 1e-6, 3000), by(ActiveSet{}));
  EXPECT_EQ(solution.summary.outcome, Outcome::tolerance_not_met);
  EXPECT_NE(solution.summary.advice.find("mesh.adaptive.max_triangles"), std::string::npos);
  EXPECT_LE(solution.mesh->triangles.size(), 3000u);
  EXPECT_GT(solution.mesh->triangles.size(), 1000u);
  EXPECT_EQ(solution.summary.error_bound->relative, solution.summary.levels.back().relative);
}

TEST(Adapt, RefusesAStartAboveItsCap) {
  EXPECT_THROW(solve(adaptive(problems::paper(Scheme::nonconforming, 40), 0.1, 3000)), InvalidProblem);
}

TEST(Adapt, EndsWhereRefinementIsOfNoUse) {
  // The solution lies in the spaces: what remains is rounding, which no mesh lowers.
  Problem problem = problems::paper(Scheme::conforming, 2);
  problem.body = {};
  problem.boundary = {{"left", Fixed{}}, {"right", Fixed{VectorField(1)}}, {"bottom", Contact{}}};
  const Solution solution = solve(adaptive(problem, 1e-300, 100000), by(ActiveSet{}));
  EXPECT_EQ(solution.summary.outcome, Outcome::tolerance_not_met);
  EXPECT_LT(solution.summary.triangles, 10000);
  EXPECT_LT(solution.summary.error_bound->relative, 1e-6);
}

TEST(Adapt, ServesTheLevelWithTheSmallestBound) {
  // The solution lies in the spaces, and rounding grows with the mesh.
  Problem problem = problems::paper(Scheme::conforming, 2);
  problem.body = {};
  problem.boundary = {{"left", Fixed{}}, {"right", Fixed{VectorField(1)}}, {"bottom", Contact{}}};
  const Solution solution = solve(adaptive(problem, 1e-300, 100000), by(ActiveSet{}));
  const std::vector<Level>& levels = solution.summary.levels;
  const Level best = *std::ranges::min_element(levels, {}, &Level::relative);
  ASSERT_LT(best.number, levels.back().number);
  ASSERT_LT(best.relative, levels.back().relative);
  EXPECT_EQ(solution.summary.error_bound->relative, best.relative);
  EXPECT_EQ(solution.summary.triangles, best.triangles);
  EXPECT_EQ(solution.mesh->triangles.size(), static_cast<std::size_t>(best.triangles));
  EXPECT_EQ(solution.error_squares.size(), best.triangles);
  EXPECT_EQ(static_cast<int>(levels.size()), levels.back().number);
  int iterations = 0;
  for (const Level& level : levels) iterations += level.iterations;
  EXPECT_EQ(solution.summary.iterations, iterations);
  EXPECT_EQ(solution.history.size(), static_cast<std::size_t>(iterations));
  EXPECT_NE(solution.summary.advice.find("level " + std::to_string(best.number) + ", the best of " +
                                         std::to_string(levels.back().number)),
            std::string::npos)
      << solution.summary.advice;
}

TEST(Adapt, KeepsWhatIsSeenOfTheOtherLevels) {
  Problem problem = problems::paper(Scheme::conforming, 2);
  problem.body = {};
  problem.boundary = {{"left", Fixed{}}, {"right", Fixed{VectorField(1)}}, {"bottom", Contact{}}};
  // The best of the first is not its last.
  for (const Problem& adapted :
       {adaptive(problem, 1e-300, 10000), adaptive(problems::paper(Scheme::nonconforming, 4), 0.1, 100000)}) {
    const Solution solution = solve(adapted, by(ActiveSet{}));
    const std::vector<Level>& levels = solution.summary.levels;
    ASSERT_EQ(solution.levels.size() + 1, levels.size());
    int before = 0;
    for (const LevelFields& level : solution.levels) {
      EXPECT_GT(level.number, std::exchange(before, level.number));
      const Level& row = levels[static_cast<std::size_t>(level.number) - 1];
      EXPECT_NE(row.triangles, solution.summary.triangles);
      EXPECT_EQ(level.triangles.size(), static_cast<std::size_t>(row.triangles));
      EXPECT_EQ(level.error_squares.size(), row.triangles);
      EXPECT_LE(std::sqrt(level.error_squares.sum()), row.bound * (1 + 1e-9));
      EXPECT_EQ(level.displacement_at_points.cols(), static_cast<Eigen::Index>(level.points.size()));
    }
  }
}

TEST(Adapt, LowersTheBoundWhereAHoleTouches) {
  for (const Scheme scheme : schemes)
    for (const double poisson : {0.3, 0.49999})
      for (const int corners : {3, 4, 12}) {
        const int most = sanitized ? 400 : 3000;
        const Solution solution =
            solve(adaptive(problems::touching_hole(scheme, poisson, corners), 1e-9, most), by(ActiveSet{}));
        const std::vector<Level>& levels = solution.summary.levels;
        EXPECT_GT(levels.back().triangles, most / 2) << solution.summary.advice;
        if (!sanitized) {
          EXPECT_LT(levels.back().relative, scheme == Scheme::conforming ? 0.2 : 0.5);
        }
        for (std::size_t i = 1; i < levels.size(); ++i) {
          const double before = levels[i].triangles > 300 ? levels[i - 1].relative : 1e9;
          EXPECT_LT(levels[i].relative, 1.05 * before)
              << corners << " corners, Poisson's ratio " << poisson << ", level " << i + 1;
        }
      }
}

TEST(Adapt, SolvesElasticBodiesToOneThousandth) {
  for (const auto& [problem, most] : {std::pair(problems::pressed_angle(Scheme::conforming), 20000),
                                      {problems::half_disc(Scheme::conforming), 33000}}) {
    const double tolerance = sanitized ? 3e-2 : 1e-3;
    const Solution solution = solve(adaptive(problem, tolerance, most), by(ActiveSet{}));
    EXPECT_EQ(solution.summary.outcome, Outcome::converged) << solution.summary.advice;
    EXPECT_LE(solution.summary.error_bound->relative, tolerance);
    EXPECT_TRUE(solution.summary.error_bound->guaranteed);
    EXPECT_LE(solution.summary.levels.size(), 14u);
  }
}

TEST(Adapt, KeepsTheLastLevelWhenCancelled) {
  const Problem problem = adaptive(problems::paper(Scheme::nonconforming, 4), 1e-6, 1000000);
  UntilLevel third(3);
  const Solution solution = solve(problem, by(ActiveSet{}), third);
  EXPECT_EQ(solution.summary.outcome, Outcome::cancelled);
  EXPECT_EQ(solution.summary.levels.size(), 3u);
  EXPECT_EQ(solution.summary.triangles, solution.summary.levels.back().triangles);
  UntilLevel none(0);
  EXPECT_THROW(solve(problem, by(ActiveSet{}), none), Cancelled);
}

TEST(Adapt, KeepsTheLastLevelWhenTheTimeIsUp) {
  Settings settings = by(ActiveSet{});
  settings.time_limit = 0.3;
  const Solution solution =
      solve(adaptive(problems::paper(Scheme::nonconforming, 4), 1e-9, 20'000'000), settings);
  EXPECT_EQ(solution.summary.outcome, Outcome::time_limit);
  EXPECT_NE(solution.summary.advice.find("solver.time_limit"), std::string::npos);
  EXPECT_GT(solution.summary.levels.size(), 1u);
}

TEST(Adapt, RefusesWhatMakesNoSense) {
  const auto where = [](const Problem& problem, const Settings& settings) -> std::string {
    try {
      solve(problem, settings);
    } catch (const InvalidProblem& invalid) {
      return invalid.faults().at(0).where;
    }
    return "";
  };
  const Problem problem = problems::paper(Scheme::nonconforming, 4);
  EXPECT_EQ(where(adaptive(problem, 0.1, 1000), by(PaperUzawa{0.1, 1})), "/mesh/adaptive");
  EXPECT_EQ(where(adaptive(problem, 0, 1000), by(ActiveSet{})), "/mesh/adaptive/tolerance");
  EXPECT_EQ(where(adaptive(problem, 1, 1000), by(ActiveSet{})), "/mesh/adaptive/tolerance");
  EXPECT_EQ(where(adaptive(problem, std::numeric_limits<double>::quiet_NaN(), 1000), by(ActiveSet{})),
            "/mesh/adaptive/tolerance");
  EXPECT_EQ(where(adaptive(problem, 0.1, 0), by(ActiveSet{})), "/mesh/adaptive/max_triangles");
}

TEST(Adapt, IsEstimatedAtItsCap) {
  const Estimate estimated = estimate(adaptive(problems::paper(Scheme::nonconforming, 4), 0.1, 50000));
  EXPECT_EQ(estimated.triangles, 50000);
  EXPECT_GT(estimated.unknowns.stress, 75000);
  EXPECT_LT(estimated.unknowns.stress, 76000);
}

/// Found from outside: no triangle adds to what is known exactly, and one mesh was solved for ever.
TEST(Adaptive, EndsWhereNothingAddsToItsQuantity) {
  for (const Scheme scheme : schemes)
    for (const bool opens : {false, true}) {
      Problem problem = adaptive(problems::paper(scheme, 4), 0.01, 2000);
      Quantity nothing;
      nothing.name = "nothing";
      (opens ? nothing.openings : nothing.weights).emplace("bottom", Field(0));
      problem.quantities = {nothing};
      problem.mesh.adaptive->quantity = "nothing";
      Settings settings = by(ActiveSet{});
      settings.time_limit = 60;
      const Solution solution = solve(problem, settings);
      // The interval of a force is as wide as rounding, beside a value of 0.
      EXPECT_EQ(solution.summary.outcome, opens ? Outcome::converged : Outcome::tolerance_not_met)
          << solution.summary.advice;
      EXPECT_EQ(solution.summary.quantities.at(0).value, 0);
      EXPECT_LE(solution.summary.levels.size(), 30u);
    }
}

}  // namespace
}  // namespace signorini::adapt_test
