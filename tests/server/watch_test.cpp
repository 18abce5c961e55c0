// What is known of a solve while somebody watches it.

#include "server/jobs/watch.hpp"

#include <limits>
#include <thread>

#include <gtest/gtest.h>

namespace signorini::server::watch_test {
namespace {

using namespace std::chrono_literals;

/// Another thread looks into the database, and may come late.
TEST(Watch, KeepsWhatThisProcessKnowsOfItsOwnSolve) {
  const Time started{1000ms};
  const auto own = std::make_shared<LiveSolve>(started), seen = std::make_shared<LiveSolve>(started),
             next = std::make_shared<LiveSolve>(started + 1ms);
  Watch watch;
  watch.begin_elsewhere(seen);
  EXPECT_EQ(watch.live(), seen);
  watch.begin(own);
  watch.begin_elsewhere(seen);
  EXPECT_EQ(watch.live(), own);
  watch.begin_elsewhere(next);
  EXPECT_EQ(watch.live(), next);
}

/// Who follows a solve is told of no iteration before the phase that it belongs to.
TEST(LiveSolve, TellsItsStateAndItsIterationsOfOneMoment) {
  LiveSolve live(Time{1s});
  std::jthread solve([&](const std::stop_token& stop) {
    for (Iteration iteration; !stop.stop_requested();) {
      ++iteration.number;
      live.iterated(iteration);
    }
  });
  for (std::size_t told = 0, looks = 0; looks < 2000; ++looks) {
    const Advance advance = live.advance_after(told, std::numeric_limits<std::size_t>::max());
    told += advance.iterations.size();
    ASSERT_EQ(advance.progress.iteration, told);
  }
}

}  // namespace
}  // namespace signorini::server::watch_test
