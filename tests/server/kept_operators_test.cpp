#include "server/jobs/kept_operators.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "../problems/sanitized.hpp"
#include "api/problem/problem_json.hpp"
#include "server/handlers/submission.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/run.hpp"

namespace signorini::server::kept_operators_test {
namespace {

/// The paper's problem with n × n squares, fixed at the left; the data are of no matter.
std::string problem(int n, double gap = 0) {
  return R"({"model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [)" +
         std::to_string(n) + "," + std::to_string(n) +
         R"(]}, "material": {"stiffness": 1}, "load": {"body": -10}, "boundary": {
                            "left": {"type": "fixed"}, "bottom": {"type": "contact", "gap": )" +
         std::to_string(gap) + R"(}}, "scheme": "nonconforming"})";
}

api::Request request(int n, double gap = 0) {
  return api::parse_request(problem(n, gap));
}

bool is_reused(KeptOperators& operators, const api::Request& posed) {
  Observer indifferent;
  IdleCores cores(1);
  return solve_request(posed, indifferent, operators, cores).summary.reused;
}

/// The bytes that the operator of n × n squares takes with its key.
std::size_t bytes_of(int n) {
  KeptOperators operators(1 << 30);
  is_reused(operators, request(n));
  return operators.figures().bytes;
}

TEST(KeptOperators, AreFoundAgainAndCounted) {
  KeptOperators operators(1 << 30);
  EXPECT_FALSE(is_reused(operators, request(4)));
  EXPECT_TRUE(is_reused(operators, request(4, 0.1)));
  EXPECT_FALSE(is_reused(operators, request(5)));
  EXPECT_TRUE(is_reused(operators, request(4, 0.2)));
  const OperatorFigures figures = operators.figures();
  EXPECT_EQ(figures.hits, 2u);
  EXPECT_EQ(figures.misses, 2u);
  EXPECT_EQ(figures.evictions, 0u);
  EXPECT_EQ(figures.operators, 2u);
  EXPECT_EQ(figures.bytes, bytes_of(4) + bytes_of(5));
}

TEST(KeptOperators, DropTheOneUsedLeastRecently) {
  KeptOperators operators(bytes_of(6) + bytes_of(5) + bytes_of(4) / 2);
  is_reused(operators, request(4));
  is_reused(operators, request(5));
  EXPECT_TRUE(is_reused(operators, request(4)));
  is_reused(operators, request(6));  // no room for three: 5 has to go
  EXPECT_EQ(operators.figures().evictions, 1u);
  EXPECT_EQ(operators.figures().bytes, bytes_of(6) + bytes_of(4));
  EXPECT_TRUE(is_reused(operators, request(4)));
  EXPECT_TRUE(is_reused(operators, request(6)));
  EXPECT_FALSE(is_reused(operators, request(5)));
}

TEST(KeptOperators, NeverHoldMoreThanTheLimit) {
  for (const std::size_t limit : {std::size_t{0}, bytes_of(4) - 1}) {
    KeptOperators operators(limit);
    for (int i = 0; i < 2; ++i) EXPECT_FALSE(is_reused(operators, request(4)));
    EXPECT_EQ(operators.figures().operators, 0u);
    EXPECT_EQ(operators.figures().bytes, 0u);
  }
}

/// Neither what is dropped for its factor nor the factor of another counts.
TEST(KeptOperators, AreOfNoSolvesMemory) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  const auto peak = [](KeptOperators& operators, int n) {
    Observer indifferent;
    IdleCores cores(1);
    return static_cast<double>(
        solve_request(request(n), indifferent, operators, cores).summary.peak_memory_bytes);
  };
  KeptOperators none(0);
  peak(none, 20);  // tables of the process
  const double alone = peak(none, 20);
  KeptOperators one(bytes_of(40) + 1);
  peak(one, 40);
  EXPECT_NEAR(peak(one, 20) / alone, 1, 0.02);
  EXPECT_EQ(one.figures().evictions, 1u);
  EXPECT_LT(peak(one, 20), alone);
  EXPECT_GT(peak(one, 20), 0.4 * alone);
}

/// A service with factors at hand, of which clients with names ask for the same problem.
class OperatorsOfNames : public testing::Test {
 protected:
  NewJob job_of(const std::string& name) {
    Request sent;
    sent.identity.name = name;
    return new_job(service_, sent, {problem(4), request(4), {}});
  }
  /// Whether a fleet would let the job begin here for the sake of its factor.
  bool is_at_hand(const NewJob& job) const {
    const std::vector<std::int64_t> marks = operators_.marks();
    return std::ranges::find(marks, job.operator_mark) != marks.end();
  }
  bool is_reused_by(const NewJob& job) {
    store_.add(job);
    const Claim claim = store_.claim().value();
    LiveSolve live(std::chrono::system_clock::now());
    const Ending ending = run(claim, solve_, live, 1e9, Factorization::multifrontal);
    store_.finish(claim, ending);
    return ending.solution->summary.reused;
  }

  KeptOperators operators_{1 << 30};
  IdleCores cores_{1};
  const SolveFunction solve_ = [this](const api::Request& posed, Observer& observer) {
    return solve_request(posed, observer, operators_, cores_);
  };
  MemoryStore store_{StoreLimits{4, 1 << 30, std::chrono::hours(1)}};
  Scheduler scheduler_{store_, solve_, 0};
  EventStreams events_{1};
  Access access_;
  Metrics metrics_;
  Service service_{store_, scheduler_, events_, access_, {}, operators_, metrics_};
};

/// Else one could find out what another has solved.
TEST_F(OperatorsOfNames, ServeTheirNameAlone) {
  for (const char* name : {"anne", "zoe", ""}) {
    const NewJob first = job_of(name), again = job_of(name);
    EXPECT_FALSE(is_at_hand(first)) << name;
    EXPECT_FALSE(is_reused_by(first)) << name;
    EXPECT_TRUE(is_at_hand(again)) << name;
    EXPECT_TRUE(is_reused_by(again)) << name;
  }
  EXPECT_TRUE(is_reused_by(job_of("anne")));
}

TEST(KeptOperators, HaveTheKeyOfTheProblemWhereThereAreNoNames) {
  EXPECT_EQ(operator_key_of("", "key"), "key");
  EXPECT_EQ(operator_key_of("anne", ""), "");
}

TEST(KeptOperators, ServeWorkersWhileTheyAreDropped) {
  KeptOperators operators(bytes_of(6) + 1);
  std::vector<std::thread> workers;
  for (int worker = 0; worker < 4; ++worker)
    workers.emplace_back([&operators, worker] {
      for (int i = 0; i < 20; ++i) is_reused(operators, request(4 + (worker + i) % 3, 0.01 * i));
    });
  for (std::thread& worker : workers) worker.join();
  const OperatorFigures figures = operators.figures();
  EXPECT_EQ(figures.hits + figures.misses, 80u);
  EXPECT_LE(figures.bytes, bytes_of(6) + 1);
  EXPECT_GT(figures.evictions, 0u);
}

}  // namespace
}  // namespace signorini::server::kept_operators_test
