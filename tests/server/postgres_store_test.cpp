// What a store does that several processes share.

#include "server/jobs/postgres/store.hpp"

#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "lost_claim.hpp"
#include "postgres_server.hpp"
#include "server/jobs/postgres/url.hpp"
#include "store_jobs.hpp"

namespace signorini::server::postgres_store_test {
namespace {

using namespace std::chrono_literals;
using postgres::Connection;

/// Two processes with one database.
class PostgresStore : public testing::Test {
 protected:
  static StoreLimits limits(std::size_t queue = 1000) { return {queue, plenty, std::chrono::hours(1)}; }

  Heartbeat beat(const Claim& claim) const {
    Heartbeat heartbeat;
    heartbeat.job = claim.job.id;
    heartbeat.attempt = claim.attempt;
    return heartbeat;
  }
  Standing renew(postgres::Store& store, const Heartbeat& heartbeat) const {
    return store.fleet()->renew(std::span(&heartbeat, 1)).front();
  }
  Found look(const Sought& sought) const { return b_.fleet()->look(std::span(&sought, 1)).at(0); }

  const std::string url_ = empty_database();
  postgres::Store a_{url_, limits(), lease_of_stores};
  mutable postgres::Store b_{url_, limits(), lease_of_stores};
};

TEST_F(PostgresStore, OneThatIsSilentLosesItsJobAndNothingMoreIsAcceptedOfIt) {
  a_.add(new_job("a"));
  const Claim lost = a_.claim().value();
  b_.fleet()->rescue();
  EXPECT_FALSE(b_.claim());
  std::this_thread::sleep_for(lease_of_stores);
  b_.fleet()->rescue();
  EXPECT_EQ(b_.find("a")->status, JobStatus::queued);
  EXPECT_FALSE(b_.find("a")->started);
  const Claim held = b_.claim().value();
  EXPECT_GT(held.attempt, lost.attempt);
  EXPECT_EQ(renew(a_, beat(lost)), Standing::lost);
  EXPECT_FALSE(a_.finish(lost, success()));
  EXPECT_FALSE(a_.finish(lost, success(std::size_t{3} << 20)));
  EXPECT_FALSE(a_.give_back(lost));
  EXPECT_EQ(a_.fleet()->stale_writes(), 4u);
  EXPECT_EQ(b_.find("a")->status, JobStatus::running);
  EXPECT_TRUE(b_.finish(held, success()));
  EXPECT_EQ(b_.fleet()->stale_writes(), 0u);
  EXPECT_EQ(a_.find("a")->status, JobStatus::succeeded);
}

TEST_F(PostgresStore, OneThatRenewsKeepsItsJob) {
  a_.add(new_job("a"));
  const Claim claim = a_.claim().value();
  for (int i = 0; i < 6; ++i) {
    std::this_thread::sleep_for(lease_of_stores / 3);
    EXPECT_EQ(renew(a_, beat(claim)), Standing::held);
    b_.fleet()->rescue();
  }
  EXPECT_TRUE(a_.finish(claim, success()));
}

TEST_F(PostgresStore, AJobIsTriedThreeTimesButWhatIsGivenBackDoesNotCount) {
  a_.add(new_job("a"));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(a_.give_back(a_.claim().value()));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(a_.claim()) << i;
    std::this_thread::sleep_for(lease_of_stores + 1ms);
    b_.fleet()->rescue();
  }
  const Job job = *a_.find("a");
  EXPECT_EQ(job.status, JobStatus::failed);
  EXPECT_EQ(job.verdict.error->kind, "attempts-used-up");
  EXPECT_TRUE(job.finished);
  EXPECT_FALSE(a_.claim());
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::failed, 1}}));
}

TEST_F(PostgresStore, OneRunsWhatAnotherCancels) {
  a_.add(new_job("a"));
  const Claim claim = a_.claim().value();
  EXPECT_EQ(b_.cancel("a"), Cancellation::asked);
  EXPECT_EQ(renew(a_, beat(claim)), Standing::to_be_cancelled);
  EXPECT_FALSE(a_.give_back(claim));
  std::this_thread::sleep_for(lease_of_stores + 1ms);
  b_.fleet()->rescue();
  EXPECT_EQ(b_.find("a")->status, JobStatus::cancelled);
}

TEST_F(PostgresStore, AnotherSeesHowFarASolveIs) {
  a_.add(new_job("a"));
  EXPECT_EQ(look({"a"}).attempt, 0u);
  const Claim claim = a_.claim().value();
  Heartbeat heartbeat = beat(claim);
  heartbeat.advance.progress.phase = Phase::iterate;
  heartbeat.advance.iterations.resize(2);
  heartbeat.advance.iterations.back().number = 2;
  renew(a_, heartbeat);
  // As if the answer had been lost: the next one tells the same again, and more.
  heartbeat.advance.iterations.resize(3);
  renew(a_, heartbeat);
  const Found found = look({"a", claim.attempt, 1});
  EXPECT_EQ(found.status, JobStatus::running);
  EXPECT_EQ(iso8601(*found.started), iso8601(*claim.job.started));
  EXPECT_EQ(found.advance.progress.phase, Phase::iterate);
  ASSERT_EQ(found.advance.iterations.size(), 2u);
  EXPECT_EQ(found.advance.iterations.front().number, 2);
  heartbeat.told = 3;
  renew(a_, heartbeat);
  EXPECT_EQ(look({"a", claim.attempt, 3}).advance.iterations.size(), 3u);
  EXPECT_EQ(look({"a"}).advance.iterations.size(), 6u);
  EXPECT_EQ(look({"a", claim.attempt + 7, 5}).advance.iterations.size(), 6u);

  Ending ending = cancelled_ending("enough");
  ending.history = std::make_shared<const std::vector<Iteration>>(9);
  a_.finish(claim, ending);
  EXPECT_EQ(look({"a", claim.attempt, 5}).advance.iterations.size(), 4u);
  EXPECT_EQ(look({"a"}).status, JobStatus::cancelled);
  const Sought nothing{"b"};
  EXPECT_TRUE(b_.fleet()->look(std::span(&nothing, 1)).empty());
}

TEST_F(PostgresStore, ALargeResultIsKeptInPieces) {
  a_.add(new_job("a"));
  const Claim claim = a_.claim().value();
  const Ending ending = success(std::size_t{5} << 20);
  EXPECT_TRUE(a_.finish(claim, ending));
  EXPECT_EQ(b_.result("a")->solution->displacement_at_points, ending.solution->displacement_at_points);
  EXPECT_GT(b_.result_memory("a"), std::size_t{5} << 20);
  EXPECT_LT(b_.result_memory("a"), std::size_t{6} << 20);
}

TEST_F(PostgresStore, WhatIsDamagedFailsAndHarmsNoOther) {
  for (const char* id : {"a", "b"}) {
    a_.add(new_job(id));
    a_.finish(a_.claim().value(), success(2000));
  }
  Connection(url_, 5s).script(
      "UPDATE results SET bytes = set_byte(bytes, 999, get_byte(bytes, 999) # 1) "
      "WHERE job = 'a'");
  EXPECT_FALSE(a_.result("a")->solution);
  EXPECT_EQ(b_.find("a")->verdict.error->kind, "damaged");
  EXPECT_EQ(b_.damaged(), 1u);
  EXPECT_TRUE(a_.result("b")->solution);
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::failed, 1}, {JobStatus::succeeded, 1}}));
}

TEST_F(PostgresStore, OneOfManyWithTheSameKeyIsTaken) {
  std::vector<std::thread> threads;
  std::vector<std::string> taken(8);
  for (std::size_t i = 0; i < taken.size(); ++i)
    threads.emplace_back([&, i] {
      taken[i] = (i % 2 == 0 ? a_ : b_).add(new_job(std::string(1, static_cast<char>('a' + i)), "{}", "key"));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::ranges::count(taken, taken.front()), std::ssize(taken));
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::queued, 1}}));
}

TEST_F(PostgresStore, ABatchIsOneRequestHasItsKeyAndGoesWithItsJobs) {
  NewBatch batch;
  batch.batch = {"x", "loads", {"t"}, "anne", std::chrono::system_clock::now(), {"b", "c"}};
  batch.key = "key";
  batch.digest = "1";
  for (const std::string& id : batch.batch.jobs) {
    NewJob job = new_job(id);
    job.owner = "anne";
    job.batch = "x";
    batch.jobs.push_back(job);
  }
  postgres::Store small(url_, limits(2), lease_of_stores);
  small.add(batch);
  EXPECT_EQ(b_.add(batch).id, "x");
  EXPECT_EQ(b_.find_batch("x")->jobs, batch.batch.jobs);
  EXPECT_EQ(small.add(new_job("d")), "d");
  EXPECT_THROW(small.add(new_job("e")), QueueFull);
  batch.digest = "2";
  EXPECT_THROW(b_.add(batch), KeyReused);
  NewJob with_its_key = new_job("f", "{}", "key");
  with_its_key.owner = "anne";
  EXPECT_THROW(b_.add(with_its_key), KeyReused);

  EXPECT_FALSE(a_.ends_of_batch("x", 0).all);
  EXPECT_TRUE(a_.finish(a_.claim().value(), success()));
  BatchEnds ends = b_.ends_of_batch("x", 0);
  EXPECT_EQ(ends.jobs, std::vector<std::string>{"b"});
  EXPECT_EQ(a_.cancel("c"), Cancellation::ended);
  ends = b_.ends_of_batch("x", ends.latest);
  EXPECT_EQ(ends.jobs.back(), "c");
  EXPECT_TRUE(ends.all);
  EXPECT_EQ(b_.count_of_batch("x"), (JobCounts{{JobStatus::succeeded, 1}, {JobStatus::cancelled, 1}}));
  EXPECT_EQ(b_.remove_ended(batch.batch.jobs), 2u);
  EXPECT_FALSE(b_.find_batch("x"));
  EXPECT_NO_THROW(b_.add(with_its_key));
}

TEST_F(PostgresStore, AnOwnerOfManyJobsLeavesOthersTheirTurn) {
  const auto add = [&](const std::string& id, const std::string& owner) {
    NewJob job = new_job(id);
    job.owner = owner;
    a_.add(job);
  };
  for (const char* id : {"a1", "a2", "a3", "a4", "a5"}) add(id, "anne");
  EXPECT_EQ(a_.claim().value().job.id, "a1");
  EXPECT_EQ(a_.claim().value().job.id, "a2");
  for (const char* id : {"b1", "b2"}) add(id, "bert");
  std::vector<std::string> order;
  while (const auto claim = b_.claim()) order.push_back(claim->job.id);
  EXPECT_EQ(order, (std::vector<std::string>{"a3", "a4", "b1", "a5", "b2"}));
}

TEST_F(PostgresStore, TurnsGoByWeight) {
  const auto add = [&](const std::string& id, const std::string& owner, double weight) {
    NewJob job = new_job(id);
    job.owner = owner;
    job.share.weight = weight;
    a_.add(job);
  };
  for (const char* id : {"a1", "a2", "a3"}) add(id, "anne", 1);
  for (const char* id : {"b1", "b2", "b3", "b4"}) add(id, "bert", 2);
  std::vector<std::string> order;
  while (const auto claim = b_.claim()) order.push_back(claim->job.id);
  EXPECT_EQ(order, (std::vector<std::string>{"a1", "b1", "a2", "b2", "b3", "a3", "b4"}));
}

TEST_F(PostgresStore, JobsWhoseOperatorIsAtHandComeFirstButNotForEver) {
  const auto add = [&](int number, std::int64_t mark) {
    NewJob job = new_job("j" + std::to_string(100 + number));
    job.operator_mark = mark;
    a_.add(job);
  };
  for (int i = 0; i < 40; ++i) add(i, i % 2 == 0 ? 7 : 8);
  std::vector<std::string> order;
  while (const auto claim = b_.fleet()->claim({.operators = {8, 9}})) order.push_back(claim->job.id);
  ASSERT_EQ(order.size(), 40u);
  EXPECT_EQ((std::vector<std::string>(order.begin(), order.begin() + 10)),
            (std::vector<std::string>{"j101", "j103", "j105", "j107", "j109", "j111", "j113", "j115", "j100",
                                      "j117"}));
}

TEST_F(PostgresStore, WhatTakesTooMuchMemoryWaitsForAnother) {
  NewJob large = new_job("a");
  large.predicted_memory = 100;
  a_.add(large);
  EXPECT_FALSE(a_.fleet()->claim({.memory = 99}));
  EXPECT_EQ(b_.fleet()->claim({.memory = 100}).value().predicted_memory, 100);
  for (const char* id : {"b", "c"}) {
    NewJob of_anne = new_job(id);
    of_anne.predicted_memory = 60;
    of_anne.owner = "anne";
    of_anne.share.memory = 100;
    a_.add(of_anne);
  }
  const Claim first = a_.claim().value();
  EXPECT_FALSE(b_.claim());
  a_.finish(first, success());
  EXPECT_TRUE(b_.claim());
}

TEST_F(PostgresStore, ANewerOneIsRefused) {
  Connection(url_, 5s).script("UPDATE schema_version SET version = 99");
  EXPECT_THROW(postgres::Store(url_, limits(), lease_of_stores), CannotOpenStore);
}

TEST_F(PostgresStore, ManyThatStartAtTheSameTimeMakeTheTablesOnce) {
  const std::string fresh = empty_database();
  std::atomic<int> opened = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 6; ++i)
    threads.emplace_back([&] {
      postgres::Store(fresh, limits(), lease_of_stores).count();
      ++opened;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(opened, 6);
}

TEST_F(PostgresStore, WhatIsNoIdIsNotThere) {
  for (const std::string& id : {std::string("\xff"), std::string("a\0", 2), std::string("'; DROP")}) {
    EXPECT_FALSE(a_.find(id));
    EXPECT_FALSE(a_.find_batch(id));
  }
  EXPECT_TRUE(a_.list({.title = "\xff"}).jobs.empty());
  EXPECT_TRUE(a_.list({.tag = "\xff"}).jobs.empty());
}

TEST_F(PostgresStore, IsThereAgainWhenItsServerIs) {
  PostgresServer server;
  postgres::Store store(server.new_database("jobs"), limits(), lease_of_stores);
  store.add(new_job("a"));
  EXPECT_FALSE(store.trouble());
  server.end(SIGQUIT);
  EXPECT_THROW(store.add(new_job("b")), StoreUnavailable);
  EXPECT_TRUE(store.trouble());
  EXPECT_THROW(store.fleet()->hint(), StoreUnavailable);
  server.start();
  std::this_thread::sleep_for(600ms);
  EXPECT_FALSE(store.trouble());
  EXPECT_EQ(store.add(new_job("b")), "b");
  EXPECT_EQ(store.claim().value().job.id, "a");
}

TEST_F(PostgresStore, HintsComeFromOthers) {
  EXPECT_FALSE(a_.fleet()->wait_for_hint(10ms));
  b_.fleet()->hint();
  EXPECT_TRUE(a_.fleet()->wait_for_hint(2s));
  EXPECT_FALSE(a_.fleet()->wait_for_hint(10ms));
}

TEST(PostgresUrl, IsShownWithoutItsPassword) {
  EXPECT_EQ(postgres::without_password("postgresql://anne:se:cret@host:5432/jobs?sslmode=require"),
            "postgresql://anne@host:5432/jobs?sslmode=require");
  EXPECT_EQ(postgres::without_password("postgresql:///jobs?password=secret&user=anne"),
            "postgresql:///jobs?user=anne");
  EXPECT_EQ(postgres::without_password("postgresql:///jobs?user=anne&password=secret"),
            "postgresql:///jobs?user=anne&");
  EXPECT_EQ(postgres::without_password("postgresql://anne@host/jobs"), "postgresql://anne@host/jobs");
}

}  // namespace
}  // namespace signorini::server::postgres_store_test
