#include "server/jobs/kept_operators.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "../problems/sanitized.hpp"
#include "api/problem/problem_json.hpp"
#include "server/jobs/run.hpp"

namespace signorini::server::kept_operators_test {
namespace {

/// The paper's problem with n × n squares, fixed at the left; the data are of no matter.
api::Request request(int n, double gap = 0) {
  return api::parse_request(
      R"({"model": "membrane", "domain": {"type": "rectangle"}, "mesh": {"divisions": [)" +
      std::to_string(n) + "," + std::to_string(n) +
      R"(]}, "material": {"stiffness": 1}, "load": {"body": -10}, "boundary": {
                            "left": {"type": "fixed"}, "bottom": {"type": "contact", "gap": )" +
      std::to_string(gap) + R"(}}, "scheme": "nonconforming"})");
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
