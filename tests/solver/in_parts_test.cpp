// What several threads do for one solve is what one thread does, and ends as it does.

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "problems/sanitized.hpp"
#include "problems/threads.hpp"
#include "progress/executor.hpp"
#include "progress/in_parts.hpp"
#include "progress/memory_meter.hpp"

namespace signorini::in_parts_test {
namespace {

constexpr int kMany = 100'000;

/// Answers false from the second time on.
class Impatient : public Observer {
 public:
  bool keep_going() override { return asked_++ == 0; }

 private:
  int asked_ = 0;
};

void wait_a_little() {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

TEST(InParts, CoverTheLoopOnce) {
  Threads threads(4);
  Observer observer;
  for (Executor* executor : {static_cast<Executor*>(nullptr), static_cast<Executor*>(&threads)})
    for (const int count : {0, 1, 2047, 2048, 2049, kMany}) {
      Progress progress(observer, {}, 0, executor);
      std::vector<int> times(count, 0);
      in_parts(count, progress, [&](Part part, Progress&) {
        for (int i = part.begin; i < part.end; ++i) ++times[i];
      });
      EXPECT_EQ(times, std::vector<int>(count, 1));
    }
}

/// Sums of floating-point numbers depend on their order.
TEST(InParts, AddUpInOrderWhoeverFindsThem) {
  Observer observer;
  const auto sum = [&](Executor* executor) {
    Progress progress(observer, {}, 0, executor);
    double all = 0;
    in_parts(
        kMany, progress,
        [](Part part, Progress&) {
          double own = 0;
          for (int i = part.begin; i < part.end; ++i) own += 1. / (i + 1);
          if (part.begin % 3 == 0) wait_a_little();
          return own;
        },
        [&](double own) { all = all / 3 + own; });
    return all;
  };
  Threads two(2), five(5);
  const double alone = sum(nullptr);
  for (int again = 0; again < 5; ++again) {
    EXPECT_EQ(sum(&two), alone);
    EXPECT_EQ(sum(&five), alone);
  }
}

TEST(InParts, TheFirstFailureIsTold) {
  Threads threads(3);
  Observer observer;
  Progress progress(observer, {}, 0, &threads);
  int added = 0;
  const auto fails = [&] {
    in_parts(
        kMany, progress,
        [](Part part, Progress&) {
          // The first to fail is not the first to be found.
          if (part.begin == 3 * 2048) std::this_thread::sleep_for(std::chrono::milliseconds(30));
          if (part.begin >= 3 * 2048) throw SolveError(std::to_string(part.begin / 2048));
          return 1;
        },
        [&](int one) { added += one; });
  };
  for (int again = 0; again < 5; ++again) {
    added = 0;
    try {
      fails();
      FAIL();
    } catch (const SolveError& failure) {
      EXPECT_STREQ(failure.what(), "3");
    }
    EXPECT_LE(added, 3);
  }
}

/// Only the thread of the solve asks its observer, and the others hear of it.
TEST(InParts, EndWithTheSolve) {
  Threads threads(3);
  Impatient impatient;
  Progress progress(impatient, {}, 0, &threads);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(side_by_side(3, progress,
                            [](int, Progress& its) {
                              for (int i = 0; i < 10'000; ++i) {
                                its.check();
                                wait_a_little();
                              }
                            }),
               Cancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(InParts, EndWithTheSolveThatWaitsForOthers) {
  Threads threads(2);
  Impatient impatient;
  Progress progress(impatient, {}, 0, &threads);
  const auto caller = std::this_thread::get_id();
  EXPECT_THROW(side_by_side(2, progress,
                            [&](int, Progress& its) {
                              if (std::this_thread::get_id() == caller) {
                                std::this_thread::sleep_for(std::chrono::milliseconds(20));
                                return;
                              }
                              for (int i = 0; i < 10'000; ++i) {
                                its.check();
                                wait_a_little();
                              }
                            }),
               Cancelled);
}

TEST(InParts, MemoryOfHelpersIsOfTheSolve) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  constexpr std::size_t bytes = 1 << 20;
  Threads threads(2);
  Observer observer;
  Progress progress(observer, {}, 0, &threads);
  std::vector<std::vector<char>> kept(2);
  std::atomic<int> at_work = 0;
  const MemoryMeter memory;
  side_by_side(2, progress, [&](int number, Progress&) {
    ++at_work;
    while (at_work < 2) std::this_thread::yield();  // one on each thread
    kept[number] = std::vector<char>(bytes);
    const std::vector<char> for_a_while(2 * bytes);
    EXPECT_EQ(for_a_while.back(), 0);
  });
  EXPECT_GE(memory.peak(), 6 * bytes);
  EXPECT_LT(memory.peak(), 6.5 * bytes);
  const MemoryMeter after;
  kept.clear();
  EXPECT_LE(after.peak(), 1000);
}

TEST(InParts, HelpersHaveTheLimitOfTheSolve) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  constexpr std::size_t bytes = 1 << 20;
  Threads threads(2);
  Observer observer;
  Progress progress(observer, {}, 0, &threads);
  const auto caller = std::this_thread::get_id();
  const MemoryLimit limit(bytes);
  std::atomic<int> at_work = 0;
  EXPECT_THROW(side_by_side(2, progress,
                            [&](int, Progress&) {
                              ++at_work;
                              while (at_work < 2) std::this_thread::yield();
                              if (std::this_thread::get_id() == caller) return;
                              const std::vector<char> too_much(2 * bytes);
                              EXPECT_EQ(too_much.back(), 0);
                            }),
               std::bad_alloc);
  EXPECT_TRUE(MemoryLimit::was_met());
}

}  // namespace
}  // namespace signorini::in_parts_test
