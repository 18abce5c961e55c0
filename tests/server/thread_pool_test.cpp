#include "server/http/thread_pool.hpp"

#include <atomic>
#include <chrono>
#include <latch>

#include <gtest/gtest.h>

namespace signorini::server::thread_pool_test {
namespace {

TEST(ThreadPool, DoesEverythingBeforeItEnds) {
  std::atomic<int> done = 0;
  {
    ThreadPool pool(4, 2);
    for (int i = 0; i < 1000; ++i) pool.enqueue({[&] { ++done; }});
  }
  EXPECT_EQ(done, 1000);
}

TEST(ThreadPool, HasOnlyAFewAtWork) {
  std::atomic<int> at_work = 0;
  std::atomic<int> most = 0;
  {
    ThreadPool pool(8, 2);
    for (int i = 0; i < 50; ++i) {
      pool.enqueue({[&] {
        const int now = ++at_work;
        for (int before = most; before < now && !most.compare_exchange_weak(before, now);) continue;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        --at_work;
      }});
    }
  }
  EXPECT_LE(most, 2);
}

/// Each waits for all of them: without a rest, the second would never begin.
TEST(ThreadPool, LetsOthersWorkMeanwhile) {
  std::latch all(6);
  std::atomic<int> done = 0;
  {
    ThreadPool pool(6, 1);
    for (int i = 0; i < 6; ++i) {
      pool.enqueue({[&] {
        {
          const ThreadPool::Waiting rest;
          all.arrive_and_wait();
        }
        ++done;
      }});
    }
  }
  EXPECT_EQ(done, 6);
}

/// And what they hold is given back while others wait, whoever's turn is next.
TEST(ThreadPool, DoesNothingForThoseWhoHaveLeft) {
  std::latch begun(1), may_go_on(1);
  std::atomic<int> done = 0;
  std::atomic<bool> left = false;
  const auto held = std::make_shared<int>();
  ThreadPool pool(1, 1);
  pool.enqueue({[&] {
    begun.count_down();
    may_go_on.wait();
  }});
  begun.wait();
  for (int i = 0; i < 100; ++i) pool.enqueue({[&, held] { ++done; }, "a", {}, [&] { return left.load(); }});
  left = true;
  may_go_on.count_down();
  pool.shutdown();
  EXPECT_EQ(done, 0);
  EXPECT_EQ(held.use_count(), 1);
}

}  // namespace
}  // namespace signorini::server::thread_pool_test
