// Convergence studies: the table, the true errors in it and the rates observed.
#include "run/study.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "norms.hpp"
#include "problems/elasticity.hpp"
#include "problems/sanitized.hpp"
#include "result/true_errors.hpp"

namespace signorini::study_test {
namespace {

const Settings active_set{ActiveSet{}, std::nullopt};
const std::vector<Scheme> both{Scheme::conforming, Scheme::nonconforming};

std::vector<StudyMesh> squares(const std::vector<Divisions>& divisions) {
  std::vector<StudyMesh> meshes;
  for (const Divisions& each : divisions)
    meshes.push_back({"/study/divisions/" + std::to_string(meshes.size()), MeshRequest(each)});
  return meshes;
}

std::vector<StudyRow> run(const Problem& problem, const Study& study, const Settings& settings = active_set) {
  Observer indifferent;
  return run_study(problem, study, settings, indifferent);
}

std::optional<double> bound_of(const StudyRow& row) {
  return row.error_bound ? std::optional(row.error_bound->value) : std::nullopt;
}

RowNumber error(std::optional<double> TrueErrors::*which) {
  return [which](const StudyRow& row) { return row.errors.*which; };
}

Exact exact_edge() {
  using Edge = problems::SignoriniEdge;
  // J(u) = ½ ∫ 9/4 |x|, in closed form.
  const double energy = 9. / 8 * 2 / 3 * (std::sqrt(2.) + std::asinh(1.));
  return {VectorField(problems::function(Edge::u)),
          {problems::function([](const Point& x) { return Edge::stress(x).x(); }),
           problems::function([](const Point& x) { return Edge::stress(x).y(); })},
          energy};
}

/// What Theorems 4.3 and 4.5 promise, 3/4 and 1/2, holds of the bound on the errors; more is seen.
TEST(Study, ReproducesTheOrdersOfTheTheoremsOnThePapersProblem) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  Study study{both, squares({{4, 4}, {8, 8}, {16, 16}, {32, 32}, {64, 64}, {128, 128}}), {}};
  study.exact.energy = -0.914792950798;
  const std::vector<StudyRow> rows = run(problems::paper(Scheme::conforming, 4), study);
  ASSERT_EQ(rows.size(), 12u);
  for (const StudyRow& row : rows) {
    ASSERT_EQ(row.error, "");
    ASSERT_TRUE(row.error_bound && row.error_bound->guaranteed);
    EXPECT_LE(row.error_bound->energy_lower, *study.exact.energy);
    EXPECT_GE(row.error_bound->energy_upper, *study.exact.energy);
  }
  for (const auto& [scheme, promised, seen] :
       {std::tuple(Scheme::conforming, 0.75, 1.4), std::tuple(Scheme::nonconforming, 0.5, 0.95)}) {
    const double bound = fitted_rate(rows, scheme, bound_of).value();
    const double energy = fitted_rate(rows, scheme, error(&TrueErrors::energy)).value();
    std::printf("observed rates: bound %.3f, energy %.3f\n", bound, energy);
    EXPECT_GE(bound, promised);
    EXPECT_GE(bound, seen);
    EXPECT_GE(energy, 2 * promised);
  }
}

TEST(Study, PutsTheTrueErrorsBesideTheBound) {
  const Study study{both, squares({{8, 4}, {16, 8}, {32, 16}, {64, 32}}), exact_edge()};
  const std::vector<StudyRow> rows = run(problems::SignoriniEdge::problem(Scheme::conforming, 1), study);
  ASSERT_EQ(rows.size(), 8u);
  for (const StudyRow& row : rows) {
    const TrueErrors& errors = row.errors;
    EXPECT_EQ(errors.stress, errors.energy_norm);  // κ = 1
    EXPECT_GT(*errors.total, *errors.energy_norm);
    EXPECT_LE(*errors.total, row.error_bound->value * (1 + 1e-9));
    EXPECT_GE(*errors.total, 0.5 * row.error_bound->value);
  }
  for (const auto& [scheme, order] :
       {std::pair(Scheme::conforming, 1.4), std::pair(Scheme::nonconforming, 0.95)})
    for (const auto which : {&TrueErrors::displacement, &TrueErrors::stress, &TrueErrors::total})
      EXPECT_GE(fitted_rate(rows, scheme, error(which)).value(), order);

  Problem alone = problems::SignoriniEdge::problem(Scheme::nonconforming, 32);
  const Solution solution = solve(alone, active_set);
  const StudyRow& last = rows.back();
  EXPECT_EQ(last.scheme, Scheme::nonconforming);
  EXPECT_EQ(last.level, 0);
  EXPECT_EQ(last.triangles, solution.summary.triangles);
  EXPECT_EQ(last.unknowns.stress, solution.summary.unknowns.stress);
  EXPECT_EQ(last.energy, solution.summary.energy);
  EXPECT_NEAR(last.size, std::sqrt(2.) / 32, 1e-15);
  EXPECT_NEAR(*last.errors.stress, stress_error(solution, problems::SignoriniEdge::stress),
              1e-3 * *last.errors.stress);
  EXPECT_NEAR(*last.errors.displacement, displacement_error(solution, problems::SignoriniEdge::u),
              1e-3 * *last.errors.displacement);
}

/// The contact term of the total error for a solution and a displacement that need not be the exact one.
double contact_term(const Problem& problem, const Exact& exact, const Solution& solution) {
  Observer indifferent;
  const TrueErrors errors = true_errors(problem, exact, solution, indifferent);
  return std::pow(*errors.total, 2) - std::pow(*errors.energy_norm, 2) -
         2 * (solution.summary.error_bound->energy_upper - *exact.energy);
}

/// Where contact ends within an edge, p* is positive on its open part.
TEST(Study, TheTotalErrorHasBothContactTerms) {
  Problem problem = problems::SignoriniEdge::problem(Scheme::nonconforming, 1);
  problem.mesh.fineness = Divisions{5, 3};
  const Solution solution = solve(problem, active_set);
  double expected = 0;
  for (const EdgePressure& pressure : solution.admissible_pressure) {
    const auto& [a, b] = solution.mesh->edges[pressure.edge];
    const double from = solution.mesh->points[a].x(), to = solution.mesh->points[b].x();
    constexpr int parts = 10'000;
    for (int i = 0; i < parts; ++i) {
      const double s = (i + 0.5) / parts, x = from + s * (to - from);
      if (x > 0) expected += 2 * pressure(s) * std::pow(x, 1.5) * std::abs(to - from) / parts;
    }
  }
  EXPECT_GT(expected, 0.001 * std::pow(solution.summary.error_bound->value, 2));
  EXPECT_NEAR(contact_term(problem, exact_edge(), solution), expected, 0.02 * expected);
}

TEST(Study, TheContactTermOfAnElasticBodyIsTakenAlongTheDirection) {
  Problem problem = problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, 0.7);
  problem.boundary["bottom"] = Contact{0.1, Vector(3, -4)};
  problem.boundary["left"] = Fixed{};
  const Solution solution = solve(problem, active_set);
  const Exact exact{VectorField(-0.05, 0.1), {0, 0, 0}, solution.summary.error_bound->energy_lower};
  double force = 0;
  for (const EdgePressure& pressure : solution.admissible_pressure)
    force += solution.mesh->length(pressure.edge) * pressure(0.5);
  // g − u_d = 0.1 + (3 · 0.05 + 4 · 0.1) / 5.
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(contact_term(problem, exact, solution), 2 * force * 0.21, 1e-9 * force);
}

/// ½ E ε : ε by its two moduli.
double elastic_energy_density(const problems::Smooth& smooth, const Point& x) {
  const Eigen::Matrix2d strain = (smooth.gradient(x) + smooth.gradient(x).transpose()) / 2;
  return smooth.mu * strain.squaredNorm() + smooth.lambda / 2 * std::pow(strain.trace(), 2);
}

TEST(Study, MeasuresElasticErrorsInTheNormOfTheLaw) {
  for (const double poisson : {0.3, 0.4999}) {
    const problems::Smooth smooth(poisson);
    Study study{both, squares({{4, 4}, {8, 8}}), {}};
    study.exact.displacement =
        VectorField(problems::function([=](const Point& x) { return smooth.u(x).x(); }),
                    problems::function([=](const Point& x) { return smooth.u(x).y(); }));
    for (const auto& ij : {std::pair(0, 0), std::pair(1, 1), std::pair(0, 1)})
      study.exact.stress.push_back(
          problems::function([=](const Point& x) { return smooth.stress(x)(ij.first, ij.second); }));
    const std::vector<StudyRow> rows = run(smooth.problem(Scheme::conforming, 4), study);
    for (const StudyRow& row : rows) {
      ASSERT_EQ(row.error, "");
      EXPECT_LE(*row.errors.energy_norm, row.error_bound->value);
      // C ≤ 1/(2μ): the norm of the law is at most this much of that of L2.
      EXPECT_LE(*row.errors.energy_norm, *row.errors.stress / std::sqrt(2 * smooth.mu) * (1 + 1e-12));
      EXPECT_FALSE(row.errors.total);
    }
    EXPECT_GE(observed_rate(rows, 1, error(&TrueErrors::energy_norm)).value(), 1.5);
    EXPECT_GE(observed_rate(rows, 3, error(&TrueErrors::energy_norm)).value(), 0.8);
    EXPECT_LT(*rows[1].errors.displacement, 0.05);
  }
  // Against a stress of zero the norm is that of σ_h, √(2 · energy) of the exact solution but for its error.
  const problems::Smooth smooth(0.3);
  Study study{{Scheme::conforming}, squares({{16, 16}}), {}};
  study.exact.stress.assign(3, Field(0));
  const std::vector<StudyRow> rows = run(smooth.problem(Scheme::conforming, 4), study);
  double energy = 0;
  constexpr int n = 200;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      energy += elastic_energy_density(smooth, {(i + 0.5) / n, (j + 0.5) / n}) / (n * n);
  EXPECT_NEAR(*rows[0].errors.energy_norm, std::sqrt(2 * energy), 2e-3 * std::sqrt(2 * energy));
}

TEST(Study, AMeshThatRefinesItselfHasARowALevel) {
  Study study{both, {{"/study/adaptive", MeshRequest(Divisions{4, 2})}}, exact_edge()};
  study.meshes[0].request.adaptive = Adaptive{0.02, 100'000};
  const std::vector<StudyRow> rows = run(problems::SignoriniEdge::problem(Scheme::conforming, 1), study);
  std::array<int, 2> levels{};
  for (const StudyRow& row : rows) {
    ASSERT_EQ(row.error, "");
    int& level = levels[row.scheme == Scheme::nonconforming];
    EXPECT_EQ(row.level, ++level);
    EXPECT_LE(*row.errors.total, row.error_bound->value * (1 + 1e-9));
    if (row.level == 1) continue;
    EXPECT_GT(row.triangles, (&row - 1)->triangles);
    EXPECT_GT(row.seconds, (&row - 1)->seconds);
  }
  EXPECT_GE(levels[0], 2);
  EXPECT_GE(levels[1], 4);
  EXPECT_LE(rows.back().error_bound->relative, 0.02);
  EXPECT_GE(fitted_rate(rows, Scheme::nonconforming, bound_of).value(), 0.9);
}

TEST(Study, KeepsTheLevelsOfAToleranceThatIsNotMet) {
  Study study{{Scheme::nonconforming}, {{"/study/adaptive", MeshRequest(Divisions{4, 4})}}, {}};
  study.meshes[0].request.adaptive = Adaptive{1e-4, 200};
  const std::vector<StudyRow> rows = run(problems::paper(Scheme::conforming, 4), study);
  ASSERT_GE(rows.size(), 3u);
  EXPECT_EQ(rows[rows.size() - 2].error, "");
  EXPECT_NE(rows.back().error.find("/study/adaptive: "), std::string::npos);
  EXPECT_NE(rows.back().error.find("max_triangles"), std::string::npos);
  EXPECT_EQ(rows.back().triangles, 0);
}

TEST(Study, ARunThatFailsDoesNotEndTheOthers) {
  const Study study{{Scheme::nonconforming}, squares({{4, 4}, {32, 32}, {4, 4}}), {}};
  // Enough for the coarse mesh only.
  const std::vector<StudyRow> rows =
      run(problems::paper(Scheme::conforming, 4), study, {Mprgp{1e-8, 12}, {}});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].error, "");
  EXPECT_EQ(rows[1].error.find("/study/divisions/1: "), 0u) << rows[1].error;
  EXPECT_EQ(rows[2].error, "");
  EXPECT_FALSE(observed_rate(rows, 1, bound_of));
}

/// No document takes a number that is infinite.
TEST(Study, ARowWithoutFiniteErrorsSaysSo) {
  Study study{{Scheme::nonconforming}, squares({{4, 4}}), exact_edge()};
  study.exact.stress[0] = Field(-1e308);
  const std::vector<StudyRow> rows = run(problems::paper(Scheme::nonconforming, 4), study);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NE(rows[0].error.find("leave the range"), std::string::npos) << rows[0].error;
}

TEST(Study, TheTimeLimitIsForTheWhole) {
  const Study study{{Scheme::nonconforming}, squares({{4, 4}, {4, 4}}), {}};
  Observer indifferent;
  const std::vector<StudyRow> rows =
      run_study(problems::paper(Scheme::conforming, 4), study, {ActiveSet{}, 5., 6.}, indifferent);
  ASSERT_EQ(rows.size(), 2u);
  for (const StudyRow& row : rows) EXPECT_NE(row.error.find("time limit"), std::string::npos);
}

TEST(Study, CountsItsRunsAndEndsWhenItIsAskedTo) {
  struct Counting : Observer {
    std::size_t done = 0, count = 0;
    bool keep_going() override { return done < 2; }
    void studied(std::size_t now, std::size_t all) override { done = now, count = all; }
  } counting;
  const Study study{both, squares({{4, 4}, {8, 8}}), {}};
  EXPECT_THROW(run_study(problems::paper(Scheme::conforming, 4), study, active_set, counting), Cancelled);
  EXPECT_EQ(counting.done, 2u);
  EXPECT_EQ(counting.count, 4u);
}

TEST(Study, IsEstimatedUntilThereAreEnoughUnknowns) {
  const Study study{both, squares({{4, 4}, {8, 8}}), {}};
  const Problem problem = problems::paper(Scheme::conforming, 4);
  const auto estimated = [&](Factorization by, std::int64_t enough) {
    Settings settings = active_set;
    settings.factorization = by;
    return estimate(problem, {}, study, settings, enough).runs;
  };
  const std::vector<Estimate> all = estimated(Factorization::multifrontal, 100'000);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[3].triangles, 128);
  EXPECT_EQ(all[3].unknowns.stress, 208);
  const std::int64_t first_two = all[0].unknowns.stress + all[1].unknowns.stress;
  EXPECT_EQ(estimated(Factorization::multifrontal, first_two).size(), 3u);
  EXPECT_EQ(estimated(Factorization::cholmod, first_two - 1).size(), 2u);
}

TEST(Study, HasTheInfSupConstantOfEachMeshIfItIsAskedFor) {
  Study study{{Scheme::nonconforming}, squares({{2, 1}, {8, 4}}), {}};
  Problem problem = problems::block(Scheme::conforming, Pattern::right, 3, 0.3);
  problem.body = VectorField(0, -1);
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{}}};
  EXPECT_FALSE(run(problem, study)[0].inf_sup);
  study.checks_inf_sup = true;
  // The coarser mesh is mended before it is solved on: see InfSup.OfAStripHeldByOneEdgeIsZeroUntilItIsMended.
  for (const StudyRow& row : run(problem, study)) {
    ASSERT_EQ(row.error, "");
    EXPECT_GT(row.inf_sup.value(), 0.1);
  }
  study.meshes = {{"/study/adaptive", MeshRequest(Divisions{4, 4})}};
  study.meshes[0].request.adaptive = Adaptive{0.2, 4000};
  const std::vector<StudyRow> levels = run(problem, study);
  EXPECT_GT(levels.size(), 1u);
  for (const StudyRow& row : levels) EXPECT_GT(row.inf_sup.value_or(0), 0.1) << row.error;
}

/// The time is up while the bound is computed, which is given a little more; the check is not.
TEST(Study, HasNoMoreTimeForTheInfSupConstantThanThereIs) {
  struct Slow : Observer {
    void entered(Phase phase) override {
      if (phase == Phase::certify) std::this_thread::sleep_for(std::chrono::milliseconds(1050));
    }
  } observer;
  Study study{{Scheme::conforming}, squares({{2, 2}}), {}};
  study.checks_inf_sup = true;
  Settings settings = active_set;
  settings.time_limit = 1;
  const std::vector<StudyRow> rows = run_study(
      problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, 1), study, settings, observer);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NE(rows[0].error.find("before the inf-sup constant was known"), std::string::npos) << rows[0].error;
}

TEST(Study, RefusesInfSupConstantsThatTakeTooMuch) {
  Study study{both, squares({{4, 4}, {200, 200}}), {}};
  const Problem problem = problems::pressed_block(Scheme::nonconforming, Pattern::right, 0.3, 1);
  EXPECT_TRUE(validate(problem, study, active_set).empty());
  study.checks_inf_sup = true;
  const std::vector<Fault> faults = validate(problem, study, active_set);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "/study/divisions/1");
  EXPECT_NE(faults[0].detail.find("801600 stress unknowns"), std::string::npos) << faults[0].detail;
}

TEST(Study, TellsWhatIsWrongWithIt) {
  Study study{both, squares({{4, 4}, {0, 4}}), {}};
  study.meshes.push_back({"/study/adaptive", MeshRequest(Divisions{4, 4})});
  study.meshes.back().request.adaptive = Adaptive{0.1, 100};
  const Problem problem = problems::paper(Scheme::conforming, 4);
  const std::vector<Fault> faults = validate(problem, study, {PaperUzawa{0.1, 1}, {}});
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].where, "/study/divisions/1");
  EXPECT_EQ(faults[1].where, "/study/adaptive");

  Study infinite{both, squares({{4, 4}}), {}};
  infinite.exact.displacement = VectorField(
      problems::function([](const Point& x) { return 1 / (x.x() - x.x()); }, "/study/exact/displacement"));
  infinite.exact.stress = {
      Field(1), problems::function([](const Point&) { return std::nan(""); }, "/study/exact/stress/1")};
  const std::vector<Fault> values = validate(problem, infinite, active_set);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].where, "/study/exact/displacement");
  EXPECT_EQ(values[1].where, "/study/exact/stress/1");
}

std::vector<StudyRow> made_up(Scheme scheme, const std::vector<std::pair<int, double>>& values) {
  std::vector<StudyRow> rows;
  for (const auto& [triangles, value] : values) {
    StudyRow row;
    row.scheme = scheme;
    row.triangles = triangles;
    row.errors.stress = value;
    rows.push_back(row);
  }
  return rows;
}

TEST(StudyRates, AreExponentsOfTheEdgeLength) {
  const RowNumber stress = error(&TrueErrors::stress);
  std::vector<StudyRow> rows = made_up(Scheme::conforming, {{8, 4}, {32, 1}, {128, 0.5}});
  EXPECT_FALSE(observed_rate(rows, 0, stress));
  EXPECT_NEAR(observed_rate(rows, 1, stress).value(), 2, 1e-14);
  EXPECT_NEAR(observed_rate(rows, 2, stress).value(), 1, 1e-14);
  EXPECT_NEAR(fitted_rate(rows, Scheme::conforming, stress).value(), 1.5, 1e-14);
  EXPECT_FALSE(fitted_rate(rows, Scheme::nonconforming, stress));

  // Over a failed row and over a zero they reach back to the last number, never to another scheme.
  rows[1].error = "no";
  EXPECT_FALSE(observed_rate(rows, 1, stress));
  EXPECT_NEAR(observed_rate(rows, 2, stress).value(), 1.5, 1e-14);
  rows[1].error.clear();
  rows[1].errors.stress = 0;
  EXPECT_FALSE(observed_rate(rows, 1, stress));
  EXPECT_NEAR(observed_rate(rows, 2, stress).value(), 1.5, 1e-14);
  rows[2].scheme = Scheme::nonconforming;
  EXPECT_FALSE(observed_rate(rows, 2, stress));
  EXPECT_FALSE(fitted_rate(rows, Scheme::nonconforming, stress));

  EXPECT_FALSE(observed_rate(made_up(Scheme::conforming, {{8, 2}, {8, 1}}), 1, stress));
  EXPECT_FALSE(fitted_rate(made_up(Scheme::conforming, {{8, 2}, {8, 1}}), Scheme::conforming, stress));
}

}  // namespace
}  // namespace signorini::study_test
