// What is known of a solve while somebody watches it.

#include "server/jobs/watch.hpp"

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

}  // namespace
}  // namespace signorini::server::watch_test
