#include "server/http/crew.hpp"

#include <atomic>
#include <chrono>
#include <latch>

#include <gtest/gtest.h>

namespace signorini::server {
namespace {

TEST(Crew, DoesEverythingBeforeItEnds) {
  std::atomic<int> done = 0;
  {
    Crew crew(4, 2);
    for (int i = 0; i < 1000; ++i) crew.enqueue([&] { ++done; });
  }
  EXPECT_EQ(done, 1000);
}

TEST(Crew, HasOnlyAFewAtWork) {
  std::atomic<int> at_work = 0;
  std::atomic<int> most = 0;
  {
    Crew crew(8, 2);
    for (int i = 0; i < 50; ++i) {
      crew.enqueue([&] {
        const int now = ++at_work;
        for (int before = most; before < now && !most.compare_exchange_weak(before, now);) continue;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        --at_work;
      });
    }
  }
  EXPECT_LE(most, 2);
}

/// Each waits for all of them: without a rest, the second would never begin.
TEST(Crew, LetsOthersWorkMeanwhile) {
  std::latch all(6);
  std::atomic<int> done = 0;
  {
    Crew crew(6, 1);
    for (int i = 0; i < 6; ++i) {
      crew.enqueue([&] {
        {
          const Crew::Rest rest;
          all.arrive_and_wait();
        }
        ++done;
      });
    }
  }
  EXPECT_EQ(done, 6);
}

}  // namespace
}  // namespace signorini::server
