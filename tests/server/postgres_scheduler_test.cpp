// Workers of a process that loses its jobs.

#include <atomic>
#include <thread>

#include "becomes.hpp"
#include "postgres_server.hpp"
#include "scripted_solve.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/scheduler.hpp"
#include "store_jobs.hpp"

#include <gtest/gtest.h>

namespace signorini::server::postgres_scheduler_test {
namespace {

using namespace std::chrono_literals;

constexpr auto lease = 1s;

/// The one that has lost it does not hear that it is to end, and ends while the other one solves.
TEST(PostgresScheduler, AJobMayComeBackToTheProcessThatLostIt) {
  const std::string url = empty_database();
  const StoreLimits limits{10, plenty, std::chrono::hours(1)};
  postgres::Store store(url, limits, lease), other(url, limits, lease);
  std::atomic<int> begun = 0, let_go = 0;
  Scheduler scheduler(
      store,
      [&](const api::Request&, Observer&) -> Solution {
        const int run = ++begun;
        while (let_go < run) std::this_thread::sleep_for(1ms);
        return {};
      },
      2);
  scheduler.submit(new_job("a", problem_titled("deaf")));
  const auto watch = scheduler.watch("a");
  ASSERT_TRUE(becomes([&] { return begun == 1; }, 5s));
  postgres::Connection connection(url, 5s);
  ASSERT_TRUE(becomes(
      [&] {
        connection.script("UPDATE leases SET until = 0 WHERE attempt = 1");
        other.fleet()->rescue();
        return begun == 2;
      },
      5s));
  let_go = 1;
  std::this_thread::sleep_for(3 * lease);
  EXPECT_EQ(begun, 2);
  EXPECT_FALSE(watch->over());
  let_go = 2;
  EXPECT_TRUE(becomes([&] { return store.find("a")->status == JobStatus::succeeded; }, 5s));
  EXPECT_EQ(connection.run("SELECT attempt FROM jobs").integer(0, 0), 2);
  let_go = 9;
}

}  // namespace
}  // namespace signorini::server::postgres_scheduler_test
