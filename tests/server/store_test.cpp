// What every store of jobs does, run for each of them.

#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "becomes.hpp"
#include "postgres_server.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/sqlite/store.hpp"
#include "store_jobs.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::store_test {
namespace {

struct StoreKind {
  const char* name;
  std::function<std::unique_ptr<JobStore>(const std::string& directory, const StoreLimits& limits)> open;
};

void PrintTo(const StoreKind& kind, std::ostream* out) {
  *out << kind.name;
}

class Store : public testing::TestWithParam<StoreKind> {
 protected:
  /// One store a test.
  JobStore& open(std::size_t queue, std::size_t keep_bytes = plenty,
                 std::chrono::seconds keep = std::chrono::hours(1)) {
    store_ = GetParam().open(directory_.path(), {queue, keep_bytes, keep});
    return *store_;
  }

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<JobStore> store_;
};

TEST_P(Store, ClaimsTheOldestFirst) {
  JobStore& store = open(3);
  store.add(new_job("a"));
  store.add(new_job("b"));
  EXPECT_EQ(store.claim().value().job.id, "a");
  EXPECT_EQ(store.claim().value().job.id, "b");
  EXPECT_FALSE(store.claim());
}

TEST_P(Store, HandsOutWhatItWasGiven) {
  JobStore& store = open(3);
  NewJob sent = new_job("a", "{\"x\": \"\\u00fc \xc3\xbc\"}");
  sent.title = "a plate";
  EXPECT_EQ(store.add(sent), "a");
  Job found = *store.find("a");
  EXPECT_EQ(found.title, "a plate");
  EXPECT_EQ(found.status, JobStatus::queued);
  EXPECT_EQ(iso8601(found.created), iso8601(sent.created));
  EXPECT_FALSE(found.started);
  const Claim claim = store.claim().value();
  EXPECT_EQ(*claim.problem, *sent.problem);
  EXPECT_EQ(claim.job.title, "a plate");
  EXPECT_TRUE(claim.job.started);
  found = *store.find("a");
  EXPECT_EQ(found.status, JobStatus::running);
  EXPECT_TRUE(found.started);
  EXPECT_FALSE(found.finished);
  EXPECT_FALSE(store.result("a")->solution);
  EXPECT_EQ(*store.result("a")->problem, *sent.problem);
}

TEST_P(Store, RefusesMoreThanTheQueueHolds) {
  JobStore& store = open(2);
  store.add(new_job("a"));
  store.add(new_job("b"));
  EXPECT_THROW(store.add(new_job("c")), QueueFull);
  EXPECT_FALSE(store.find("c"));
  store.claim();
  EXPECT_NO_THROW(store.add(new_job("c")));
}

TEST_P(Store, FinishesOnceAndOnlyWithTheLatestAttempt) {
  JobStore& store = open(2);
  store.add(new_job("a"));
  Claim claim = store.claim().value();
  Claim stale = claim;
  stale.attempt += 1;
  EXPECT_FALSE(store.finish(stale, success()));
  EXPECT_TRUE(store.finish(claim, success()));
  EXPECT_FALSE(store.finish(claim, success()));
  EXPECT_FALSE(store.give_back(claim));
  EXPECT_EQ(store.find("a")->status, JobStatus::succeeded);
  EXPECT_TRUE(store.find("a")->finished);
}

TEST_P(Store, KeepsTheVerdictAndTheFields) {
  JobStore& store = open(2);
  store.add(new_job("a"));
  Ending ending = success(800);
  ending.status = JobStatus::failed;
  ending.error = ProblemDetails{"diverged", "It diverged", "take less", {{"pointer", "/a", "is b"}}};
  store.finish(store.claim().value(), ending);
  const Job found = *store.find("a");
  EXPECT_EQ(found.status, JobStatus::failed);
  EXPECT_EQ(to_json(*found.verdict.error), to_json(*ending.error));
  EXPECT_EQ(found.verdict.summary->iterations, ending.solution->summary.iterations);
  EXPECT_EQ(found.verdict.last_iteration->number, ending.history->back().number);
  const JobResult result = *store.result("a");
  EXPECT_EQ(result.solution->displacement_at_points, ending.solution->displacement_at_points);
  EXPECT_EQ(result.history->size(), ending.history->size());
}

TEST_P(Store, KeepsTheHistoryOfAnEndWithoutASolution) {
  JobStore& store = open(2);
  store.add(new_job("a"));
  Ending ending = cancelled_ending("enough");
  ending.history = std::make_shared<const std::vector<Iteration>>(7);
  store.finish(store.claim().value(), ending);
  EXPECT_FALSE(store.find("a")->verdict.summary);
  EXPECT_FALSE(store.result("a")->solution);
  EXPECT_EQ(store.result("a")->history->size(), 7u);
}

TEST_P(Store, CancelsWhatIsQueuedAndRemembersToCancelWhatRuns) {
  JobStore& store = open(2);
  store.add(new_job("a"));
  EXPECT_FALSE(store.remove_ended("a"));
  const Claim claim = store.claim().value();
  EXPECT_EQ(store.cancel("a"), Cancellation::asked);
  EXPECT_FALSE(store.remove_ended("a"));
  EXPECT_FALSE(store.give_back(claim));
  store.finish(claim, success());
  EXPECT_EQ(store.cancel("a"), Cancellation::none);
  EXPECT_TRUE(store.remove_ended("a"));
  EXPECT_FALSE(store.find("a"));
  EXPECT_FALSE(store.result("a"));
  EXPECT_FALSE(store.remove_ended("a"));
  EXPECT_EQ(store.cancel("a"), Cancellation::none);
}

TEST_P(Store, ACancelledJobLeavesTheQueue) {
  JobStore& store = open(1);
  store.add(new_job("a"));
  EXPECT_EQ(store.cancel("a"), Cancellation::ended);
  EXPECT_FALSE(store.claim());
  EXPECT_EQ(store.find("a")->status, JobStatus::cancelled);
  EXPECT_NO_THROW(store.add(new_job("b")));
}

TEST_P(Store, AJobGivenBackIsTheNextAgain) {
  JobStore& store = open(3);
  for (const char* id : {"a", "b", "c"}) store.add(new_job(id));
  const Claim a = store.claim().value();
  const Claim b = store.claim().value();
  for (const Claim& claim : {b, a}) EXPECT_TRUE(store.give_back(claim));
  EXPECT_EQ(store.find("a")->status, JobStatus::queued);
  EXPECT_FALSE(store.find("a")->started);
  const Claim again = store.claim().value();
  EXPECT_EQ(again.job.id, "a");
  EXPECT_FALSE(store.finish(a, success()));
  EXPECT_TRUE(store.finish(again, success()));
  EXPECT_EQ(store.claim().value().job.id, "b");
}

TEST_P(Store, TheSameKeyAndProblemAreTheSameJob) {
  JobStore& store = open(1);
  EXPECT_EQ(store.add(new_job("a", "{1}", "key")), "a");
  // A full queue is no hindrance: nothing is queued.
  EXPECT_EQ(store.add(new_job("b", "{1}", "key")), "a");
  EXPECT_FALSE(store.find("b"));
  try {
    store.add(new_job("b", "{2}", "key"));
    ADD_FAILURE() << "taken";
  } catch (const KeyReused& reused) {
    EXPECT_EQ(reused.id, "a");
  }
  store.finish(store.claim().value(), success());
  EXPECT_EQ(store.add(new_job("b", "{1}", "key")), "a");
  EXPECT_EQ(store.add(new_job("c", "{1}", "another")), "c");
}

TEST_P(Store, AKeyGoesWithItsJob) {
  JobStore& store = open(2);
  store.add(new_job("a", "{1}", "key"));
  store.finish(store.claim().value(), success());
  store.remove_ended("a");
  EXPECT_EQ(store.add(new_job("b", "{2}", "key")), "b");
}

TEST_P(Store, DropsTheOldestResultsButNeverTheLast) {
  JobStore& store = open(9, 26'000);
  for (const char* id : {"a", "b", "c"}) {
    store.add(new_job(id));
    store.finish(store.claim().value(), success(10'000));
  }
  EXPECT_EQ(ids(store.list({})), (std::vector<std::string>{"c", "b"}));
  store.add(new_job("d"));
  store.finish(store.claim().value(), success(1'000'000));
  EXPECT_EQ(ids(store.list({})), (std::vector<std::string>{"d"}));
}

TEST_P(Store, KeepsJobsThatHaveNotEnded) {
  JobStore& store = open(9, 0);
  store.add(new_job("a"));
  store.claim();
  store.add(new_job("b"));
  for (const char* id : {"c", "d"}) {
    store.add(new_job(id));
    store.cancel(id);
  }
  EXPECT_EQ(ids(store.list({})), (std::vector<std::string>{"d", "b", "a"}));
}

TEST_P(Store, RemovingAResultMakesRoom) {
  JobStore& store = open(9, 26'000);
  for (const char* id : {"a", "b"}) {
    store.add(new_job(id));
    store.finish(store.claim().value(), success(10'000));
  }
  store.remove_ended("b");
  store.add(new_job("c"));
  store.finish(store.claim().value(), success(10'000));
  EXPECT_EQ(ids(store.list({})), (std::vector<std::string>{"c", "a"}));
}

TEST_P(Store, DropsWhatEndedTooLongAgo) {
  JobStore& store = open(9, plenty, std::chrono::seconds(1));
  store.add(new_job("a"));
  store.finish(store.claim().value(), success());
  store.add(new_job("b"));
  store.tidy();
  EXPECT_TRUE(store.find("a"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  store.tidy();
  EXPECT_EQ(ids(store.list({})), std::vector<std::string>{"b"});
}

TEST_P(Store, ListsNewestFirstInPages) {
  JobStore& store = open(9);
  for (const char* id : {"a", "b", "c", "d"}) store.add(new_job(id));
  store.claim();
  ListQuery query;
  query.limit = 2;
  JobPage page = store.list(query);
  EXPECT_EQ(ids(page), (std::vector<std::string>{"d", "c"}));
  EXPECT_EQ(page.next, "c");
  query.after = "c";
  page = store.list(query);
  EXPECT_EQ(ids(page), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(page.next, std::nullopt);
  query.status = JobStatus::queued;
  EXPECT_EQ(ids(store.list(query)), (std::vector<std::string>{"b"}));
}

/// However few are found, and however many others there are.
TEST_P(Store, ReadsNotAllTitlesForOnePage) {
  JobStore& store = open(30'000);
  const auto id = [](std::size_t number) { return std::to_string(100'000 + number); };
  NewJob oldest = new_job(id(0));
  oldest.title = "the seal";
  store.add(oldest);
  for (std::size_t added = 0; added < titles_of_a_page; added += 1000) {
    NewBatch batch;
    batch.batch.id = "batch " + id(added);
    for (std::size_t i = 1; i <= 1000; ++i) {
      batch.jobs.push_back(new_job(id(added + i)));
      batch.jobs.back().batch = batch.batch.id;
      batch.batch.jobs.push_back(batch.jobs.back().id);
    }
    store.add(batch);
  }
  ListQuery query{.title = "seal"};
  const JobPage first = store.list(query);
  EXPECT_TRUE(first.jobs.empty());
  EXPECT_EQ(first.next, id(1));
  query.after = first.next;
  const JobPage last = store.list(query);
  EXPECT_EQ(ids(last), std::vector<std::string>{id(0)});
  EXPECT_EQ(last.next, std::nullopt);
  EXPECT_EQ(store.ids({.title = "seal"}), std::vector<std::string>{id(0)});
}

TEST_P(Store, FindsJobsByTagAndTitle) {
  JobStore& store = open(9);
  const auto add = [&](const std::string& id, const std::string& title, std::vector<std::string> tags,
                       const std::string& owner) {
    NewJob job = new_job(id);
    job.title = title;
    job.tags = std::move(tags);
    job.owner = owner;
    store.add(job);
  };
  add("a", "A Seal, 1", {"seals", "x"}, "anne");
  add("b", "a seal, 2", {"seals"}, "bert");
  add("c", "a block", {"seal", "SEALS"}, "anne");
  add("d", "50 % \xc3\x9c", {"seals", "<b>'\"\xf0\x9f\x98\x80"}, "anne");
  EXPECT_EQ(store.find("d")->tags, (std::vector<std::string>{"seals", "<b>'\"\xf0\x9f\x98\x80"}));
  EXPECT_TRUE(store.add(new_job("e")) == "e" && store.find("e")->tags.empty());

  const auto found = [&](const ListQuery& query) {
    ListQuery by_ones = query;
    by_ones.limit = 1;
    std::vector<std::string> all;
    for (JobPage page = store.list(by_ones); !page.jobs.empty(); page = store.list(by_ones)) {
      all.push_back(page.jobs.front().id);
      by_ones.after = page.next;
      if (!page.next) break;
    }
    EXPECT_EQ(ids(store.list(query)), all);
    EXPECT_EQ(store.ids(query), all);
    return all;
  };
  using Ids = std::vector<std::string>;
  EXPECT_EQ(found({.tag = "seals"}), (Ids{"d", "b", "a"}));
  EXPECT_EQ(found({.owner = "anne", .tag = "seals"}), (Ids{"d", "a"}));
  EXPECT_EQ(found({.tag = "<b>'\"\xf0\x9f\x98\x80"}), (Ids{"d"}));
  EXPECT_EQ(found({.tag = "seal"}), (Ids{"c"}));
  EXPECT_EQ(found({.tag = "%"}), Ids{});
  EXPECT_EQ(found({.title = "SEAL"}), (Ids{"b", "a"}));
  EXPECT_EQ(found({.owner = "anne", .title = "seal"}), (Ids{"a"}));
  EXPECT_EQ(found({.title = "%"}), (Ids{"d"}));
  EXPECT_EQ(found({.title = "\xc3\x9c"}), (Ids{"d"}));
  EXPECT_EQ(found({.tag = "seals", .title = "seal"}), (Ids{"b", "a"}));
  store.finish(store.claim().value(), success());
  EXPECT_EQ(found({.status = JobStatus::queued, .tag = "seals", .title = "seal"}), (Ids{"b"}));
  EXPECT_EQ(found({.status = JobStatus::succeeded, .owner = "anne", .title = "seal"}), (Ids{"a"}));
  EXPECT_EQ(found({.owner = "anne"}), (Ids{"d", "c", "a"}));
}

TEST_P(Store, RemovesManyThatHaveEndedAtOnce) {
  JobStore& store = open(9);
  for (const char* id : {"a", "b", "c", "d"}) {
    NewJob job = new_job(id);
    job.tags = {"t"};
    store.add(job);
  }
  store.finish(store.claim().value(), success());
  store.cancel("c");
  EXPECT_EQ(store.remove_ended(store.ids({.tag = "t"})), 2u);
  EXPECT_EQ(store.ids({.tag = "t"}), (std::vector<std::string>{"d", "b"}));
  EXPECT_EQ(store.remove_ended(store.ids({.tag = "t"})), 0u);
}

TEST_P(Store, GivesEachJobToOneOfManyThreads) {
  constexpr int jobs = 200;
  JobStore& store = open(jobs);
  std::atomic<int> ended = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < jobs / 4; ++i) {
        store.add(new_job(std::to_string(1000 * t + i)));
        std::optional<Claim> claim = store.claim();
        // In a fleet, others may have taken what this one saw, and not yet what they saw: it comes again.
        if (store.fleet() != nullptr) becomes([&] { return claim || (claim = store.claim()); });
        if (claim && store.finish(*claim, success())) ++ended;
        store.list({});
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ended, jobs);
  EXPECT_FALSE(store.claim());
}

std::unique_ptr<JobStore> open_memory(const std::string&, const StoreLimits& limits) {
  return std::make_unique<MemoryStore>(limits);
}

std::unique_ptr<JobStore> open_sqlite(const std::string& directory, const StoreLimits& limits) {
  return std::make_unique<SqliteStore>(directory, limits);
}

std::unique_ptr<JobStore> open_postgres(const std::string&, const StoreLimits& limits) {
  return std::make_unique<postgres::Store>(empty_database(), limits);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Store,
                         testing::Values(StoreKind{"Memory", open_memory}, StoreKind{"Sqlite", open_sqlite}),
                         [](const auto& kind) { return kind.param.name; });

INSTANTIATE_TEST_SUITE_P(Postgres, Store, testing::Values(StoreKind{"Postgres", open_postgres}),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace signorini::server::store_test
