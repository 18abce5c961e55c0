// A clock of the machine that jumps deletes nothing.

#include "running_service.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "server/jobs/retention_clock.hpp"

namespace signorini::server::clock_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr std::int64_t second = 1000, day = 24 * 3600 * second;

std::int64_t wall() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

TEST(RetentionClock, CountsADayAtMostBetweenTwoServices) {
  for (const std::int64_t away : {std::int64_t{0}, 3600 * second, 3 * day, -3 * day}) {
    const std::int64_t counted = std::clamp<std::int64_t>(away, 0, day);
    RetentionClock clock(KeptClock{1'000'000, wall() - away});
    EXPECT_NEAR(static_cast<double>(clock.now()), static_cast<double>(1'000'000 + counted), 10. * second)
        << away;
    EXPECT_EQ(clock.holds(), away < 0 || away > day) << away;
  }
}

TEST(RetentionClock, BeginsAsTheClockOfTheMachine) {
  RetentionClock clock;
  EXPECT_NEAR(static_cast<double>(clock.now()), static_cast<double>(wall()), 10. * second);
  EXPECT_FALSE(clock.holds());
}

/// Ahead by eight days for some seconds, behind by as much, and ahead for good with a new start.
TEST(ClockThatJumps, DeletesNothing) {
  if (sanitized) GTEST_SKIP() << "the sanitizers want to be loaded before the clock";
  for (const bool durable : {true, false}) {
    const TemporaryDirectory directory;
    const std::string file = directory.path() + "/ahead";
    const auto set = [&](std::int64_t seconds) { std::ofstream(file) << seconds << std::endl; };
    set(0);
    const std::vector<std::string> flags{"--data-dir", durable ? directory.path() + "/data" : ":memory:"};
    const std::vector<std::string> launcher{"env", "LD_PRELOAD=" CLOCK_SHIM, "SHIFTED_CLOCK=" + file};
    {
      Daemon daemon(flags, launcher);
      httplib::Client client("127.0.0.1", daemon.port());
      const auto solves = [&] { return json::parse(client.Get("/v1/solves")->body).at("solves").size(); };
      const auto solve = [&] {
        EXPECT_EQ(client.Post("/v1/solves?wait=60", problem_titled("small"), "application/json")->status,
                  200);
      };
      solve();
      for (const std::int64_t days : {8, 0, -8}) {
        set(days * 24 * 3600);
        std::this_thread::sleep_for(1500ms);
        solve();
      }
      EXPECT_EQ(solves(), 4u);
      EXPECT_NE(daemon.process().standard_error().find("clock of the machine has jumped"), std::string::npos);
      daemon.process().signal(SIGTERM);
      EXPECT_EQ(daemon.process().wait(20s), 0);
    }
    if (!durable) continue;
    set(8 * 24 * 3600);
    Daemon daemon(flags, launcher);
    httplib::Client client("127.0.0.1", daemon.port());
    std::this_thread::sleep_for(1500ms);
    EXPECT_EQ(json::parse(client.Get("/v1/solves")->body).at("solves").size(), 4u);
  }
}

}  // namespace
}  // namespace signorini::server::clock_test
