// Who gets which job, and what becomes of one whose runner is silent.

#include <atomic>
#include <barrier>
#include <thread>

#include <gtest/gtest.h>

#include "lost_claim.hpp"
#include "postgres_server.hpp"
#include "server/jobs/postgres/store.hpp"
#include "store_jobs.hpp"

namespace signorini::server::postgres_claims_test {
namespace {

using namespace std::chrono_literals;
using postgres::Connection;

class PostgresClaims : public testing::Test {
 protected:
  PostgresClaims() = default;

  void add(const std::string& id, const std::string& owner, double memory = 0,
           std::optional<double> share = std::nullopt) {
    NewJob job = new_job(id);
    job.owner = owner;
    job.predicted_memory = memory;
    job.share.memory = share;
    a_.add(job);
  }
  std::string numbered(const std::string& name, int number) const {
    return name + std::to_string(100 + number);
  }
  bool is_of(const std::optional<Claim>& claim, const std::string& owner) const {
    return claim && claim->job.owner == owner;
  }
  postgres::Rows ask(const std::string& sql) { return Connection(url_, 5s).run(sql); }
  /// Of the database, from now on.
  void set_clock(const std::string& by) {
    Connection(url_, 5s).script(
        "CREATE OR REPLACE FUNCTION clock_ms() RETURNS bigint LANGUAGE sql VOLATILE AS "
        "$$ SELECT (extract(epoch FROM clock_timestamp() + interval '" +
        by + "') * 1000)::bigint $$");
  }

  const std::string url_ = empty_database();
  const StoreLimits limits_{100'000, plenty, std::chrono::hours(1)};
  postgres::Store a_{url_, limits_, lease_of_stores}, b_{url_, limits_, lease_of_stores};
};

/// Two that claim at the same time do not see each other.
TEST_F(PostgresClaims, OfAnOwnerTakeNoMoreMemoryThanItsShareHoweverManyClaimAtOnce) {
  for (int i = 0; i < 4; ++i) add(numbered("a", i), "anne", 60, 100);
  // So that each begins before the other has ended.
  Connection(url_, 5s).script(
      "CREATE FUNCTION linger() RETURNS trigger LANGUAGE plpgsql AS "
      "$$ BEGIN PERFORM pg_sleep(0.05); RETURN NEW; END $$; "
      "CREATE TRIGGER linger BEFORE INSERT ON leases FOR EACH ROW EXECUTE FUNCTION linger()");
  constexpr int rounds = 4;
  std::barrier together(2);
  std::atomic<int> claims = 0, beyond = 0;
  const auto run = [&](postgres::Store& store) {
    for (int round = 0; round < rounds; ++round) {
      together.arrive_and_wait();
      const auto claim = store.claim();
      together.arrive_and_wait();
      claims += claim.has_value();
      if (&store == &a_) beyond += ask("SELECT sum(memory) > 100 FROM leases").boolean(0, 0);
      together.arrive_and_wait();
      if (claim) store.give_back(*claim);
    }
  };
  std::thread other([&] { run(b_); });
  run(a_);
  other.join();
  EXPECT_EQ(beyond, 0);
  EXPECT_EQ(claims, rounds);
}

TEST_F(PostgresClaims, AQueueIsNoLongerThanTheShareHoweverManyPostAtOnce) {
  std::atomic<int> taken = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 12; ++i)
    threads.emplace_back([&, i] {
      NewJob job = new_job(numbered("a", i));
      job.owner = "anne";
      job.share.queue = 3;
      try {
        (i % 2 == 0 ? a_ : b_).add(job);
        ++taken;
      } catch (const QueueFull&) {
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(taken, 3);
}

TEST_F(PostgresClaims, AFullQueueIsNoHindranceForTheSameKeyAtTheSameTime) {
  std::atomic<int> taken = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&, i] {
      NewJob job = new_job(numbered("a", i), "{}", "key");
      job.share.queue = 1;
      (i % 2 == 0 ? a_ : b_).add(job);
      ++taken;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(taken, 8);
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::queued, 1}}));
}

TEST_F(PostgresClaims, WhoComesDoesNotOvertakeOthersBecauseTheHeadOfTheQueueWaitsForMemory) {
  add("a1", "anne", 60, 100);
  add("a2", "anne", 60, 100);
  ASSERT_TRUE(is_of(a_.claim(), "anne"));
  for (int i = 0; i < 40; ++i) add(numbered("b", i), "bert");
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(is_of(a_.claim(), "bert"));
  for (int i = 0; i < 8; ++i) add(numbered("c", i), "carl");
  int of_carl = 0;
  for (int i = 0; i < 8; ++i) of_carl += is_of(b_.claim(), "carl");
  EXPECT_EQ(of_carl, 3);
}

TEST_F(PostgresClaims, WhatIsLargeIsPassedByWhatIsSmallForAWhileOnly) {
  add("large", "anne", 100);
  for (int i = 0; i < 40; ++i) add(numbered("b", i), "bert", 10);
  Fleet& fleet = *a_.fleet();
  int passed = 0;
  while (fleet.claim({.memory = 50, .most_memory = 100})) ++passed;
  EXPECT_EQ(passed, 16);
  // One in which it can never run goes on.
  EXPECT_TRUE(fleet.claim({.memory = 50, .most_memory = 60}));
  EXPECT_EQ(fleet.claim({.memory = 100}).value().job.id, "large");
  EXPECT_TRUE(fleet.claim({.memory = 50, .most_memory = 100}));
}

TEST_F(PostgresClaims, AreHeldWhenTheClockOfTheDatabaseIsSet) {
  add("a", "anne");
  const Claim claim = a_.claim().value();
  b_.fleet()->rescue();
  set_clock("1 hour");
  b_.fleet()->rescue();
  EXPECT_EQ(b_.find("a")->status, JobStatus::running);
  Heartbeat beat;
  beat.job = "a";
  beat.attempt = claim.attempt;
  EXPECT_EQ(a_.fleet()->renew(std::span(&beat, 1)).front(), Standing::held);
  std::this_thread::sleep_for(lease_of_stores + 50ms);
  b_.fleet()->rescue();
  EXPECT_EQ(b_.find("a")->status, JobStatus::queued);
}

TEST_F(PostgresClaims, NothingIsDroppedByAgeForADayWhenTheClockOfTheDatabaseWasSet) {
  add("a", "anne");
  a_.finish(a_.claim().value(), success());
  a_.tidy();
  set_clock("10 days");
  b_.tidy();
  EXPECT_TRUE(a_.find("a"));
  set_clock("2 hours");
  ask("UPDATE retention_clock SET seen = clock_ms(), hold_until = 0");
  postgres::Store(url_, limits_, lease_of_stores).tidy();
  EXPECT_FALSE(a_.find("a"));
}

/// Pieces of a result that was never told as a whole.
TEST_F(PostgresClaims, WhatALostOneHasStoredIsNoResult) {
  add("a", "anne");
  for (int i = 1; i <= 3; ++i) {
    const Claim claim = a_.claim().value();
    ask("INSERT INTO results VALUES ('a', " + std::to_string(claim.attempt) + ", 0, 'half')");
    EXPECT_TRUE(lose(url_, *b_.fleet(), "a"));
    EXPECT_TRUE(ask("SELECT FROM results").empty());
  }
  // As a piece that comes late would be.
  ask("INSERT INTO results VALUES ('a', 3, 0, 'half')");
  const auto result = a_.result("a");
  EXPECT_TRUE(result->problem);
  EXPECT_FALSE(result->solution);
  EXPECT_EQ(b_.find("a")->verdict.error->kind, "attempts-used-up");
  EXPECT_EQ(b_.damaged(), 0u);

  add("b", "anne");
  const Claim claim = a_.claim().value();
  ask("INSERT INTO results VALUES ('b', 1, 0, 'half')");
  a_.give_back(claim);
  EXPECT_EQ(a_.cancel("b"), Cancellation::ended);
  EXPECT_TRUE(a_.result("b")->problem);
  EXPECT_EQ(b_.find("b")->status, JobStatus::cancelled);
}

/// The connection broke off when the end was done.
TEST_F(PostgresClaims, AnEndThatIsToldAgainIsNoStaleWrite) {
  add("a", "anne");
  const Claim claim = a_.claim().value();
  const Ending ending = success(std::size_t{3} << 20);
  EXPECT_TRUE(a_.finish(claim, ending));
  EXPECT_FALSE(a_.finish(claim, ending));
  EXPECT_EQ(a_.fleet()->stale_writes(), 0u);
  EXPECT_FALSE(a_.finish(claim, cancelled_ending("late")));
  EXPECT_EQ(a_.fleet()->stale_writes(), 1u);
}

TEST_F(PostgresClaims, TellOfAnEndedJobInOnePiece) {
  add("a", "anne");
  const Claim claim = a_.claim().value();
  Heartbeat beat;
  beat.job = "a";
  beat.attempt = claim.attempt;
  beat.advance.iterations.resize(2);
  for (beat.told = 0; beat.told < 6; beat.told += 2) a_.fleet()->renew(std::span(&beat, 1));
  EXPECT_EQ(ask("SELECT FROM progress").size(), 3);
  Ending ending = success();
  ending.history = std::make_shared<const std::vector<Iteration>>(7);
  a_.finish(claim, ending);
  EXPECT_EQ(ask("SELECT FROM progress").size(), 1);
  const Sought sought{"a", claim.attempt, 4};
  EXPECT_EQ(b_.fleet()->look(std::span(&sought, 1)).front().advance.iterations.size(), 3u);
}

TEST_F(PostgresClaims, HowFarASolveIsIsKnownWithoutItsIterations) {
  add("a", "anne");
  Heartbeat beat;
  beat.job = "a";
  beat.attempt = a_.claim().value().attempt;
  beat.advance.iterations.resize(5);
  beat.advance.progress.iteration = 5;
  a_.fleet()->renew(std::span(&beat, 1));
  const Sought sought{.job = "a", .iterations = false};
  const Found found = b_.fleet()->look(std::span(&sought, 1)).front();
  EXPECT_EQ(found.advance.progress.iteration, 5);
  EXPECT_TRUE(found.advance.iterations.empty());
}

/// While its runner goes on: never an iteration that its state does not know.
TEST_F(PostgresClaims, TheStateAndTheIterationsOfASolveAreOfOneMoment) {
  add("a", "anne");
  const std::uint64_t attempt = a_.claim().value().attempt;
  std::jthread runner([&](const std::stop_token& stop) {
    Heartbeat beat;
    beat.job = "a";
    beat.attempt = attempt;
    beat.advance.iterations.resize(1);
    for (; !stop.stop_requested(); ++beat.told) {
      beat.advance.progress.iteration = static_cast<int>(beat.told) + 1;
      a_.fleet()->renew(std::span(&beat, 1));
    }
  });
  std::size_t known = 0;
  for (int i = 0; i < 300; ++i) {
    const Sought sought{"a", attempt, known};
    const Found found = b_.fleet()->look(std::span(&sought, 1)).front();
    known += found.advance.iterations.size();
    ASSERT_EQ(found.advance.progress.iteration, known);
  }
}

}  // namespace
}  // namespace signorini::server::postgres_claims_test
