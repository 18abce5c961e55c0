// Answers by a kept operator are those that a solve from scratch gives.
#include <gtest/gtest.h>

#include <thread>

#include "problems/families.hpp"
#include "problems/sanitized.hpp"

namespace signorini::reuse_test {
namespace {

Solution solve_with(problems::Shelf& shelf, const Problem& problem, const Settings& settings) {
  Observer indifferent;
  return solve(problem, settings, indifferent, shelf);
}

/// The largest difference of two fields, relative to the larger one.
double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double size = std::max(a.lpNorm<Eigen::Infinity>(), b.lpNorm<Eigen::Infinity>());
  return size > 0 ? (a - b).lpNorm<Eigen::Infinity>() / size : 0;
}

Eigen::Map<const Eigen::VectorXd> vector(const std::vector<double>& numbers) {
  return {numbers.data(), static_cast<Eigen::Index>(numbers.size())};
}

void expect_same(const Solution& found, const Solution& expected) {
  constexpr double rounding = 1e-12;
  EXPECT_EQ(found.summary.iterations, expected.summary.iterations);
  EXPECT_LT(std::abs(found.summary.energy - expected.summary.energy),
            rounding * std::abs(expected.summary.energy));
  EXPECT_LT(difference(found.stress, expected.stress), rounding);
  EXPECT_LT(difference(found.displacement, expected.displacement), rounding);
  EXPECT_LT(difference(found.displacement_at_points, expected.displacement_at_points), rounding);
  EXPECT_LT(difference(found.rotation, expected.rotation), rounding);
  ASSERT_EQ(found.contact.size(), expected.contact.size());
  for (std::size_t i = 0; i < found.contact.size(); ++i) {
    EXPECT_LT(difference(vector(found.contact[i].clearance), vector(expected.contact[i].clearance)),
              rounding);
    EXPECT_LT(difference(vector(found.contact[i].pressure), vector(expected.contact[i].pressure)), rounding);
    EXPECT_EQ(found.contact[i].gap, expected.contact[i].gap);
    EXPECT_EQ(found.contact[i].open, expected.contact[i].open);
  }
}

TEST(Reuse, GivesTheAnswersOfASolveFromScratch) {
  const std::vector<Problem> families = problems::families();
  for (std::size_t i = 0; i < families.size(); i += sanitized ? 5 : 1)
    for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{}}}) {
      if (sanitized && std::holds_alternative<Mprgp>(method)) continue;
      const Problem& family = families[i];
      problems::Shelf shelf;
      for (unsigned seed = 0; seed < (sanitized ? 2 : 4); ++seed) {
        Problem problem = problems::with_other_data(family, seed);
        const Solution expected = solve(problem, {method, {}});
        problem.operator_key = "the family";
        const Solution found = solve_with(shelf, problem, {method, {}});
        EXPECT_FALSE(expected.summary.reused);
        EXPECT_EQ(found.summary.reused, seed > 0);
        EXPECT_EQ(found.summary.timings.factorize > 0, seed == 0);
        expect_same(found, expected);
      }
      EXPECT_EQ(shelf.size(), 1u);
    }
}

TEST(Reuse, TheMethodDoesNotMatter) {
  problems::Shelf shelf;
  Problem problem = problems::paper(Scheme::nonconforming, 8);
  problem.operator_key = "paper";
  EXPECT_FALSE(solve_with(shelf, problem, {ActiveSet{}, {}}).summary.reused);
  EXPECT_TRUE(solve_with(shelf, problem, {Mprgp{1e-3, 20}, {}}).summary.reused);
  EXPECT_FALSE(solve_with(shelf, problem, {PaperUzawa{0.1, 1}, {}}).summary.reused);
}

TEST(Reuse, NeedsAKey) {
  problems::Shelf shelf;
  const Problem problem = problems::paper(Scheme::nonconforming, 8);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(solve_with(shelf, problem, {ActiveSet{}, {}}).summary.reused);
  EXPECT_EQ(shelf.size(), 0u);
}

TEST(Reuse, KeepsTheMeshThatHadToBeMended) {
  problems::Shelf shelf;
  Problem problem = problems::block(Scheme::nonconforming, Pattern::right, 3, 0.3);
  problem.mesh.fineness = Divisions{1, 1};
  problem.boundary = {{"bottom", Fixed{}}, {"top", Contact{0.01}}};
  problem.body = VectorField(0, 1);
  problem.operator_key = "coarse";
  const Solution first = solve_with(shelf, problem, {ActiveSet{}, {}});
  const Solution second = solve_with(shelf, problem, {ActiveSet{}, {}});
  EXPECT_GT(first.summary.triangles, 2);
  EXPECT_TRUE(second.summary.reused);
  EXPECT_EQ(second.summary.triangles, first.summary.triangles);
  expect_same(second, first);
}

/// It is the largest thing that a body with much contact has.
TEST(Reuse, DoesNotCopyTheContactComplement) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  problems::Shelf shelf;
  Problem strip = problems::paper(Scheme::nonconforming, 1);
  strip.domain = Rectangle{{0, 0}, {700, 1}};
  strip.mesh.fineness = Divisions{700, 1};
  strip.operator_key = "strip";
  solve_with(shelf, strip, {ActiveSet{}, {}});
  strip.body = Field(-1);
  const Summary again = solve_with(shelf, strip, {ActiveSet{}, {}}).summary;
  const double complement = std::pow(static_cast<double>(again.unknowns.contact), 2) * sizeof(double);
  EXPECT_TRUE(again.reused);
  EXPECT_GT(complement, 15e6);
  EXPECT_LT(static_cast<double>(again.peak_memory_bytes), complement);
}

TEST(Reuse, RefusesALoadThatLiftsTheBodyOff) {
  problems::Shelf shelf;
  Problem problem = problems::paper(Scheme::nonconforming, 6);
  problem.boundary = {{"bottom", Contact{}}};
  problem.body = Field(-1);
  problem.operator_key = "resting";
  EXPECT_EQ(solve_with(shelf, problem, {}).summary.outcome, Outcome::converged);
  problem.body = Field(1);
  EXPECT_THROW(solve_with(shelf, problem, {}), SolveError);
}

TEST(Reuse, ManyThreadsMayUseOneOperator) {
  problems::Shelf shelf;
  Problem family = problems::elastic(Scheme::nonconforming, 0.3);
  family.operator_key = "shared";
  solve_with(shelf, problems::with_other_data(family, 0), {ActiveSet{}, {}});
  constexpr unsigned threads = 4, solves = sanitized ? 2 : 6;
  std::vector<Solution> found(threads * solves);
  std::vector<std::thread> running;
  for (unsigned i = 0; i < threads; ++i)
    running.emplace_back([&, i] {
      for (unsigned k = i * solves; k < (i + 1) * solves; ++k)
        found[k] = solve_with(shelf, problems::with_other_data(family, k), {ActiveSet{}, {}});
    });
  for (std::thread& thread : running) thread.join();
  for (unsigned k = 0; k < found.size(); ++k) {
    EXPECT_TRUE(found[k].summary.reused);
    expect_same(found[k], solve(problems::with_other_data(family, k), {ActiveSet{}, {}}));
  }
}

}  // namespace
}  // namespace signorini::reuse_test
