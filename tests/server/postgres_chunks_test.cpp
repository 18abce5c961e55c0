// Sweeps that many solve together: the entries of one as jobs of their own.

#include <gtest/gtest.h>

#include "becomes.hpp"
#include "lost_claim.hpp"
#include "postgres_server.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/run.hpp"
#include "server/jobs/scheduler.hpp"
#include "store_jobs.hpp"

namespace signorini::server::postgres_chunks_test {
namespace {

using namespace std::chrono_literals;
using postgres::Connection;

class PostgresChunks : public testing::Test {
 protected:
  PostgresChunks() = default;

  /// A job of an owner that a worker has claimed and split into chunks of two entries.
  Claim add_whole(const std::string& id, std::size_t chunks) {
    add(id, "anne");
    const Claim whole = a_.claim().value();
    std::vector<NewChunk> new_chunks;
    for (std::size_t i = 0; i < chunks; ++i)
      new_chunks.push_back({1 + 2 * i, 2, "chunk " + std::to_string(i), 10});
    EXPECT_TRUE(fleet_.split(whole, new_chunks));
    return whole;
  }
  void add(const std::string& id, const std::string& owner) {
    NewJob job = new_job(id);
    job.owner = owner;
    a_.add(job);
  }
  Ending entries(std::size_t count) {
    Solution solution;
    solution.sweep.resize(count);
    for (std::size_t i = 0; i < count; ++i) solution.sweep[i].title = std::to_string(i);
    return ending_of(std::move(solution));
  }
  Standing standing_of(const Claim& claim) {
    Heartbeat beat;
    beat.job = claim.job.id;
    beat.attempt = claim.attempt;
    return b_.fleet()->renew(std::span(&beat, 1)).front();
  }
  postgres::Rows ask(const std::string& sql) { return Connection(url_, 5s).run(sql); }

  const std::string url_ = empty_database();
  const StoreLimits limits_{2, plenty, std::chrono::hours(1)};
  postgres::Store a_{url_, limits_, lease_of_stores}, b_{url_, limits_, lease_of_stores};
  Fleet& fleet_ = *a_.fleet();
};

TEST_F(PostgresChunks, AreClaimedByAnybodyAndSeenByNobody) {
  const Claim whole = add_whole("a", 3);
  const Claim chunk = b_.claim().value();
  EXPECT_EQ(*chunk.problem, "chunk 0");
  EXPECT_EQ(chunk.job.owner, "anne");
  EXPECT_EQ(chunk.job.chunk->whole, "a");
  EXPECT_EQ(chunk.job.chunk->first, 1u);
  EXPECT_EQ(chunk.job.chunk->count, 2u);
  EXPECT_EQ(chunk.job.created, whole.job.started);
  const Claim own = fleet_.claim_chunk("a").value();
  EXPECT_EQ(own.job.chunk->first, 3u);
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::running, 1}}));
  EXPECT_EQ(ids(a_.list({})), std::vector<std::string>{"a"});
  EXPECT_EQ(a_.ids({}), std::vector<std::string>{"a"});
  EXPECT_FALSE(a_.find(chunk.job.id));
  EXPECT_FALSE(a_.result(chunk.job.id));
  // Two more may wait, which is the limit.
  add("b", "bert");
  EXPECT_NO_THROW(add("c", "bert"));
  EXPECT_THROW(add("d", "bert"), QueueFull);

  EXPECT_TRUE(b_.finish(chunk, entries(2)));
  b_.tidy();
  std::vector<ChunkStanding> chunks = fleet_.chunks("a");
  ASSERT_EQ(chunks.size(), 3u);
  EXPECT_EQ(chunks[0].status, JobStatus::succeeded);
  EXPECT_EQ(chunks[1].status, JobStatus::running);
  EXPECT_EQ(chunks[2].status, JobStatus::queued);
  EXPECT_EQ(fleet_.entries(chunks[0].job).back().title, "1");
  EXPECT_TRUE(fleet_.entries(chunks[1].job).empty());
  EXPECT_TRUE(a_.finish(whole, success()));
  EXPECT_TRUE(fleet_.chunks("a").empty());
  EXPECT_EQ(standing_of(own), Standing::lost);
  EXPECT_EQ(ask("SELECT FROM queue").size(), 2);
  EXPECT_EQ(ask("SELECT FROM leases").size(), 0);
  EXPECT_EQ(a_.count(), (JobCounts{{JobStatus::queued, 2}, {JobStatus::succeeded, 1}}));
  EXPECT_TRUE(a_.remove_ended("a"));
}

/// The factor is at hand, and a sweep that has begun ends sooner; but others have their turns.
TEST_F(PostgresChunks, ComeBeforeWhatElseTheirOwnerHasQueued) {
  add("early", "anne");
  ask("UPDATE queue SET priority = -1");
  add_whole("whole", 4);
  add("other", "bert");
  std::vector<std::string> order;
  while (const auto claim = b_.claim()) order.push_back(claim->job.chunk ? "chunk" : claim->job.id);
  ASSERT_EQ(order.size(), 6u);
  EXPECT_EQ(order.back(), "early");
  EXPECT_LT(std::ranges::find(order, "other") - order.begin(), 3);
}

TEST_F(PostgresChunks, AreAskedToEndWithTheWhole) {
  const Claim whole = add_whole("a", 2);
  const Claim chunk = b_.claim().value();
  EXPECT_EQ(standing_of(chunk), Standing::held);
  EXPECT_EQ(a_.cancel("a"), Cancellation::asked);
  EXPECT_EQ(standing_of(chunk), Standing::to_be_cancelled);
  EXPECT_EQ(standing_of(whole), Standing::to_be_cancelled);
  EXPECT_TRUE(a_.finish(whole, cancelled_ending("")));
  EXPECT_FALSE(b_.finish(chunk, entries(2)));
  EXPECT_EQ(ask("SELECT FROM queue UNION ALL SELECT FROM leases").size(), 0);
}

TEST_F(PostgresChunks, AreRescuedByThemselvesAndOutliveTheRunnerOfTheWhole) {
  const Claim whole = add_whole("a", 1);
  ask("UPDATE leases SET until = until + 60000");  // what follows may take longer than a lease
  for (int attempt = 1; attempt <= 3; ++attempt) {
    const Claim chunk = b_.claim().value();
    EXPECT_EQ(chunk.attempt, static_cast<std::uint64_t>(attempt));
    EXPECT_TRUE(lose(url_, fleet_, chunk.job.id));
    EXPECT_FALSE(b_.finish(chunk, entries(2)));
    EXPECT_EQ(fleet_.chunks("a").front().is_given_up, attempt == 3);
  }
  EXPECT_EQ(standing_of(whole), Standing::held);
  EXPECT_TRUE(lose(url_, fleet_, "a"));
  EXPECT_EQ(fleet_.chunks("a").size(), 1u);
  EXPECT_FALSE(fleet_.split(whole, {}));
  EXPECT_EQ(b_.claim().value().job.id, "a");
  EXPECT_EQ(b_.cancel("a"), Cancellation::asked);
  EXPECT_TRUE(lose(url_, fleet_, "a"));
  EXPECT_EQ(b_.find("a")->status, JobStatus::cancelled);
  EXPECT_TRUE(fleet_.chunks("a").empty());
}

}  // namespace
}  // namespace signorini::server::postgres_chunks_test
