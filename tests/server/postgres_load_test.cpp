// How much a fleet does, and in which order. `tests/run --long` takes the lengths for which there are bounds.

#include <algorithm>
#include <atomic>
#include <iostream>
#include <numeric>
#include <regex>
#include <thread>

#include "../problems/long_tests.hpp"
#include "postgres_server.hpp"
#include "replica.hpp"
#include "server/jobs/postgres/store.hpp"
#include "store_jobs.hpp"

namespace signorini::server::postgres_load_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using postgres::Connection;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

const StoreLimits limits{1'000'000, plenty, std::chrono::hours(1)};
constexpr int workers = 4;

std::string numbered(const std::string& name, int number) {
  return name + std::to_string(1'000'000 + number);
}

/// Runs it in so many threads; how long all of them took.
template <class Work>
double seconds_of(const Work& work) {
  const auto begin = Clock::now();
  std::vector<std::thread> threads;
  for (int i = 0; i < workers; ++i) threads.emplace_back([&work, i] { work(i); });
  for (std::thread& thread : threads) thread.join();
  return Seconds(Clock::now() - begin).count();
}

void add(postgres::Store& store, int first, int count) {
  for (int i = first; i < first + count; ++i) store.add(new_job(numbered("j", i)));
}

double p99(std::vector<double> times) {
  std::ranges::sort(times);
  return times[times.size() * 99 / 100];
}

/// Seconds of each of so many claims, whose jobs end.
std::vector<double> times_of_claims(postgres::Store& store, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const auto begin = Clock::now();
    const auto claim = store.claim();
    times.push_back(Seconds(Clock::now() - begin).count());
    store.finish(*claim, success());
  }
  return times;
}

/// A job takes two commits: its claim and its end. A thousand a second are asked, or what the commits allow.
TEST(PostgresLoad, JobsAreDrainedAboutAsFastAsTheDatabaseCommits) {
  if (!long_tests()) GTEST_SKIP() << "has no bounds for less";
  const int jobs = 10'000;
  PostgresServer server({"fsync=on"});
  const std::string url = server.new_database("jobs");
  postgres::Store store(url, limits);
  add(store, 0, jobs);
  Connection(url, 10s).script("CREATE TABLE commits (n integer)");
  const int commits = 2000;  // of each
  const double of_commits = seconds_of([&](int) {
    Connection connection(url, 10s);
    for (int i = 0; i < commits; ++i) connection.run("INSERT INTO commits VALUES (1)");
  });
  std::atomic<int> drained = 0;
  const double of_jobs = seconds_of([&](int) {
    postgres::Store own(url, limits);
    while (const auto claim = own.claim()) {
      drained += own.finish(*claim, success());
    }
  });
  EXPECT_EQ(drained, jobs);
  EXPECT_EQ(store.count(), (JobCounts{{JobStatus::succeeded, static_cast<std::size_t>(jobs)}}));
  const double rate = jobs / of_jobs, commit_rate = workers * commits / of_commits;
  std::cout << rate << " jobs a second, " << commit_rate << " commits a second: " << 2 * rate / commit_rate
            << " of what two commits a job allow\n";
  if (rate < 1000) {
    EXPECT_GT(2 * rate / commit_rate, 0.1);
  }
}

TEST(PostgresLoad, ClaimsTakeTheSameTimeWithAMillionEndedJobs) {
  if (!long_tests()) GTEST_SKIP() << "has no bounds for less";
  const std::string url = empty_database();
  postgres::Store store(url, limits);
  const int claims = 2000, ended = 1'000'000;
  add(store, 0, 2 * claims);
  const double before = p99(times_of_claims(store, claims));
  Connection(url, 600s).script(
      "SET statement_timeout = 0; SET session_replication_role = replica; "
      "INSERT INTO jobs (id, status, title, tags, owner, batch, trace, created, started, finished, attempt, "
      "turn, memory, bytes) SELECT 'e' || n, 'succeeded', '', '', 'anne', '', '', 0, 0, clock_ms() + n, 1, "
      "n, 0, "
      "100 FROM generate_series(1, " +
      std::to_string(ended) + ") AS n; UPDATE tallies SET succeeded = " + std::to_string(ended) +
      " WHERE shard = 0");
  // What a fleet writes in months is in order by then: what the database does about rows that all came at
  // once would be measured beside the claims.
  Connection(url, 600s).run("VACUUM ANALYZE jobs");
  Connection(url, 600s).run("CHECKPOINT");
  const double after = p99(times_of_claims(store, claims));
  std::cout << "p99 of claims " << 1e3 * before << " ms, with " << ended << " ended jobs " << 1e3 * after
            << " ms\n";
  EXPECT_LT(after, 2 * before);
}

/// One claim a moment, as one worker of a second a job does: an owner posts nine of ten jobs, and has a
/// thousand before. The other one is to be answered as by a fleet of its own of half the size: within two
/// moments, times 1.5.
TEST(PostgresLoad, AnOwnerOfATenthOfTheLoadWaitsForItsShareAlone) {
  const std::string url = empty_database();
  postgres::Store store(url, limits);
  const int backlog = long_tests() ? 1000 : 60, moments = long_tests() ? 2000 : 80;
  const auto post = [&](const std::string& owner, int number) {
    NewJob job = new_job(numbered(owner, number));
    job.owner = owner;
    store.add(job);
  };
  for (int i = 0; i < backlog; ++i) post("large", i);
  std::map<std::string, int> posted;
  std::vector<int> waits;
  for (int moment = 0; moment < moments; ++moment) {
    if (moment % 10 == 0) {
      post("small", moment);
      posted[numbered("small", moment)] = moment;
    } else {
      post("large", backlog + moment);
    }
    const Claim claim = store.claim().value();
    store.finish(claim, success());
    if (claim.job.owner == "small") waits.push_back(moment + 1 - posted.at(claim.job.id));
  }
  ASSERT_GE(waits.size(), posted.size() - 1);
  std::ranges::sort(waits);
  std::cout << "answers within " << waits[waits.size() / 2] << " moments, the latest " << waits.back()
            << "\n";
  EXPECT_LE(waits[waits.size() / 2], 3);
}

/// What is updated often stays small: by what PostgreSQL does within a page.
TEST(PostgresLoad, WhatChangesOftenStaysSmall) {
  if (!long_tests()) GTEST_SKIP() << "has no bounds for less";
  constexpr int jobs = 10'000;
  const std::string url = empty_database();
  postgres::Store store(url, limits);
  const double seconds = seconds_of([&](int worker) {
    postgres::Store own(url, limits);
    for (int i = 0; i < jobs / workers; ++i) {
      own.add(new_job(numbered("j" + std::to_string(worker), i)));
      const auto claim = own.claim();
      if (!claim) continue;
      Heartbeat beat;
      beat.job = claim->job.id;
      beat.attempt = claim->attempt;
      for (int renewal = 0; renewal < 5; ++renewal) own.fleet()->renew(std::span(&beat, 1));
      own.finish(*claim, success());
    }
  });
  while (const auto claim = store.claim()) store.finish(*claim, success());
  const postgres::Rows sizes = Connection(url, 10s).run(
      "SELECT relname::text, pg_total_relation_size(relid)::bigint, n_dead_tup, n_tup_upd, n_tup_hot_upd "
      "FROM "
      "pg_stat_user_tables ORDER BY 2 DESC");
  std::cout << jobs << " jobs in " << seconds << " s\n";
  for (int row = 0; row < sizes.size(); ++row) {
    const std::string table = sizes.text(row, 0);
    const std::int64_t bytes = sizes.integer(row, 1);
    std::cout << table << ": " << bytes / 1024 << " kB, " << sizes.integer(row, 2) << " dead rows, "
              << sizes.integer(row, 4) << " of " << sizes.integer(row, 3) << " updates in place\n";
    if (table == "leases" || table == "tallies" || table == "retention_clock") {
      EXPECT_LT(bytes, std::int64_t{4} << 20) << table;
    }
    if (table == "queue") {
      EXPECT_LT(bytes, std::int64_t{16} << 20);
    }
  }
}

std::size_t count_in(Replica& replica, const std::string& metric) {
  const std::string text = replica.get("/metrics")->body;
  const std::size_t place = text.find("\n" + metric + " ");
  return std::stoul(text.substr(place + metric.size() + 2));
}

TEST(PostgresLoad, RepeatedMeshesFindTheirFactors) {
  const int meshes = long_tests() ? 10 : 2, repeats = long_tests() ? 100 : 10;
  const std::string url = empty_database();
  Replica front(url, {"--role", "front", "--queue-limit", "10000"});
  std::vector<std::unique_ptr<Replica>> replicas;
  for (int i = 0; i < (long_tests() ? workers : 2); ++i)
    replicas.push_back(
        std::make_unique<Replica>(url, std::vector<std::string>{"--role", "worker", "--workers", "1"}));
  json problem = json::parse(front.get("/v1/examples/elastic-block")->body);
  std::vector<std::string> ids;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (int mesh = 0; mesh < meshes; ++mesh) {
      problem["mesh"]["divisions"] = {8 + 2 * mesh, 6};
      problem["boundary"]["top"]["pressure"] = 1 + 0.01 * repeat;
      ids.push_back(json::parse(front.post(problem.dump())->body).at("id"));
    }
  const auto begin = Clock::now();
  const auto status = [&](const std::string& id) -> std::string { return front.status_of(id).at("status"); };
  for (const std::string& id : ids)
    while (status(id) != "succeeded" && Clock::now() - begin < 300s) std::this_thread::sleep_for(10ms);
  std::size_t hits = 0, misses = 0;
  for (const auto& replica : replicas) {
    hits += count_in(*replica, "signorini_operator_cache_hits_total");
    misses += count_in(*replica, "signorini_operator_cache_misses_total");
  }
  std::cout << hits << " of " << hits + misses << " solves found their factor\n";
  // On a machine that is busy with other things, claims are lost and solves run again.
  EXPECT_GE(hits + misses, ids.size());
  EXPECT_GE(static_cast<double>(hits), (long_tests() ? 0.9 : 0.7) * static_cast<double>(ids.size()));
}

}  // namespace
}  // namespace signorini::server::postgres_load_test
