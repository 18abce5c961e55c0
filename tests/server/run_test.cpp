// A job from its text to its end.

#include "server/jobs/run.hpp"

#include <gtest/gtest.h>

#include "../problems/no_cache.hpp"
#include "../problems/sanitized.hpp"
#include "example_problems.hpp"
#include "solve.hpp"

namespace signorini::server::run_test {
namespace {

Claim claim_of(const std::string& problem) {
  Claim claim;
  claim.problem = std::make_shared<const std::string>(problem);
  return claim;
}

Ending run_within(double bytes, const SolveFunction& solve) {
  LiveSolve live(std::chrono::system_clock::now());
  return run(claim_of(paper_problem(64).dump()), solve, live, bytes, Factorization::multifrontal);
}

Solution solve_alone(const api::Request& request, Observer& observer) {
  NoCache nowhere;
  IdleCores cores(2);
  return solve_request(request, observer, nowhere, cores);
}

TEST(Run, BeyondItsMemoryEndsWithAClearWord) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  const Ending ending = run_within(1e6, solve_alone);
  EXPECT_EQ(ending.status, JobStatus::failed);
  ASSERT_TRUE(ending.error);
  EXPECT_EQ(ending.error->kind, "memory-exceeded");
  EXPECT_NE(ending.error->detail.find("1 MB"), std::string::npos) << ending.error->detail;
  EXPECT_EQ(run_within(1e9, solve_alone).status, JobStatus::succeeded);
}

/// The runs of a study may be larger than the problem that they vary.
TEST(Run, CountsTheMemoryOfItsStudy) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  nlohmann::json problem = paper_problem(8);
  problem["study"] = {{"divisions", {16, 128}}, {"schemes", {"nonconforming"}}};
  const api::Request request = api::parse_request(problem.dump());
  Observer indifferent;
  const auto peak = static_cast<double>(solve_alone(request, indifferent).summary.peak_memory_bytes);
  const double predicted = estimate(request.problem, {}, request.study, request.settings).memory_bytes();
  EXPECT_LE(peak, predicted);
  EXPECT_GE(peak, predicted / 2);
}

/// The limit is that of a run: what comes after it on the same thread may take what it needs.
TEST(Run, LeavesNoLimitBehind) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  run_within(2e6, solve_alone);
  EXPECT_NO_THROW(std::vector<char>(100'000'000));
}

/// A limit that reading the problem has used up leaves nothing for the solve.
TEST(Run, ReadingCountsForTheTimeLimit) {
  double spent = 0;
  run_within(1e9, [&](const api::Request& request, Observer&) {
    spent = request.settings.spent;
    return Solution{};
  });
  EXPECT_GT(spent, 0);

  api::Request request = api::parse_request(paper_problem(8).dump());
  request.settings.time_limit = 5;
  request.settings.spent = 6;
  Observer indifferent;
  EXPECT_THROW(solve_alone(request, indifferent), TimeUp);
  request.settings.spent = 0;
  EXPECT_NO_THROW(solve_alone(request, indifferent));
}

/// It is no fault of the method, which may have converged before the time was over.
TEST(Run, SaysThatTheTimeWasOver) {
  const Ending ending = run_within(1e9, [](const api::Request&, Observer&) {
    Solution solution;
    solution.summary.outcome = Outcome::time_limit;
    return solution;
  });
  EXPECT_EQ(ending.status, JobStatus::failed);
  ASSERT_TRUE(ending.error);
  EXPECT_EQ(ending.error->kind, "time-limit");
}

}  // namespace
}  // namespace signorini::server::run_test
