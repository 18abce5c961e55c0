// What the store on disk does beyond store_test.cpp: it survives.

#include "server/jobs/sqlite/store.hpp"

#include "running_service.hpp"

#include <cstdlib>
#include <fstream>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "faulty_disk.hpp"
#include "server/jobs/sqlite/schema.hpp"
#include "server/jobs/stored_form.hpp"
#include "store_jobs.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::sqlite_store_test {
namespace {

class SqliteStoreTest : public testing::Test {
 protected:
  ~SqliteStoreTest() override { FaultyDisk::fail(FaultyDisk::Fault::none); }

  /// As a process does that starts; the one before has died where it was.
  SqliteStore& reopen(const StoreLimits& limits = {100, plenty, std::chrono::hours(1)}) {
    store_.reset();
    store_ = std::make_unique<SqliteStore>(directory_.path(), limits, FaultyDisk::vfs());
    return *store_;
  }

  void close() { store_.reset(); }

  std::string reason_not_to_open() {
    try {
      reopen();
    } catch (const CannotOpenStore& error) {
      return error.what();
    }
    return "";
  }

  SQLite::Database database() {
    return SQLite::Database(file(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  }
  std::string file() const { return directory_.path() + "/jobs.sqlite"; }

  TemporaryDirectory directory_;

 private:
  std::unique_ptr<SqliteStore> store_;
};

TEST_F(SqliteStoreTest, KeepsEverythingAcrossProcesses) {
  SqliteStore& first = reopen();
  first.add(new_job("a", "{1}", "key"));
  const Ending ending = success(800);
  first.finish(first.claim().value(), ending);
  first.add(new_job("b", "{2}"));

  SqliteStore& second = reopen();
  EXPECT_EQ(second.find("a")->status, JobStatus::succeeded);
  EXPECT_EQ(second.result("a")->solution->displacement_at_points, ending.solution->displacement_at_points);
  EXPECT_EQ(second.add(new_job("c", "{1}", "key")), "a");
  EXPECT_EQ(*second.claim().value().problem, "{2}");
}

TEST_F(SqliteStoreTest, QueuesAgainWhatRanWhenTheProcessDied) {
  SqliteStore& first = reopen();
  first.add(new_job("a"));
  const Claim dead = first.claim().value();
  SqliteStore& second = reopen();
  ASSERT_EQ(second.find("a")->status, JobStatus::queued);
  EXPECT_FALSE(second.find("a")->started);
  EXPECT_FALSE(second.finish(dead, success()));
  const Claim claim = second.claim().value();
  EXPECT_NE(claim.attempt, dead.attempt);
  EXPECT_FALSE(second.finish(dead, success()));
  EXPECT_TRUE(second.finish(claim, success()));
}

TEST_F(SqliteStoreTest, TriesThreeTimesAndNoMore) {
  reopen().add(new_job("a"));
  for (int attempt = 1; attempt <= 3; ++attempt) {
    EXPECT_TRUE(reopen().claim()) << attempt;
  }
  SqliteStore& store = reopen();
  EXPECT_FALSE(store.claim());
  const Job job = *store.find("a");
  EXPECT_EQ(job.status, JobStatus::failed);
  EXPECT_TRUE(job.finished);
  EXPECT_EQ(job.verdict.error->kind, "attempts-used-up");
}

TEST_F(SqliteStoreTest, AnAttemptGivenBackDoesNotCount) {
  reopen().add(new_job("a"));
  for (int i = 0; i < 5; ++i) {
    SqliteStore& store = reopen();
    EXPECT_TRUE(store.give_back(store.claim().value()));
  }
  for (int attempt = 1; attempt <= 3; ++attempt) EXPECT_TRUE(reopen().claim()) << attempt;
  EXPECT_EQ(reopen().find("a")->status, JobStatus::failed);
}

TEST_F(SqliteStoreTest, DoesNotRunAgainWhatWasToBeCancelled) {
  SqliteStore& store = reopen();
  store.add(new_job("a"));
  store.claim();
  EXPECT_EQ(store.cancel("a"), Cancellation::asked);
  EXPECT_EQ(reopen().find("a")->status, JobStatus::cancelled);
}

TEST_F(SqliteStoreTest, CountsWhatIsThereAlready) {
  SqliteStore& first = reopen();
  for (const char* id : {"a", "b"}) {
    first.add(new_job(id));
    first.finish(first.claim().value(), success(10'000));
  }
  SqliteStore& second = reopen({100, 25'000, std::chrono::hours(1)});
  second.add(new_job("c"));
  second.finish(second.claim().value(), success(10'000));
  EXPECT_EQ(ids(second.list({})), (std::vector<std::string>{"c", "b"}));
}

TEST_F(SqliteStoreTest, LeavesNothingOfWhatIsRemoved) {
  SqliteStore& store = reopen();
  NewJob job = new_job("a", "{}", "key");
  job.tags = {"t"};
  store.add(job);
  store.finish(store.claim().value(), success(1000));
  store.remove_ended("a");
  close();
  SQLite::Database raw = database();
  for (const char* table : {"jobs", "job_tags", "problems", "results", "idempotency_keys"}) {
    EXPECT_EQ(raw.execAndGet(std::string("SELECT count(*) FROM ") + table).getInt(), 0) << table;
  }
}

TEST_F(SqliteStoreTest, BelongsToOneServiceAtATime) {
  reopen();
  try {
    SqliteStore(directory_.path(), {});
    ADD_FAILURE() << "opened twice";
  } catch (const CannotOpenStore& error) {
    EXPECT_NE(std::string(error.what()).find("another service"), std::string::npos) << error.what();
  }
}

TEST_F(SqliteStoreTest, SaysWhyItCannotBeOpened) {
  std::ofstream(directory_.path() + "/a-file") << "x";
  EXPECT_THROW(SqliteStore(directory_.path() + "/a-file", {}), CannotOpenStore);
  EXPECT_THROW(SqliteStore(directory_.path() + "/a-file/below", {}), CannotOpenStore);
  // Where even root may not write.
  EXPECT_THROW(SqliteStore("/proc/sys", {}), CannotOpenStore);
  std::ofstream(file()) << "this is no database, and long enough to be seen as none "
                        << std::string(4096, 'x');
  const std::string reason = reason_not_to_open();
  EXPECT_NE(reason.find("jobs.sqlite"), std::string::npos) << reason;
  EXPECT_NE(reason.find("not a database"), std::string::npos) << reason;
}

TEST_F(SqliteStoreTest, TakesOverTheJobsOfAnOlderVersion) {
  {
    SQLite::Database old = database();
    migrate(old, 1);
    old.exec("INSERT INTO jobs (id, status, title, created, bytes) VALUES ('a', 'queued', 'old', 7, 0)");
    SQLite::Statement problem(old, "INSERT INTO problems VALUES ('a', ?)");
    const std::string packed = pack_text("{}");
    problem.bind(1, packed.data(), static_cast<int>(packed.size()));
    problem.exec();
    EXPECT_EQ(old.execAndGet("PRAGMA user_version").getInt(), 1);
  }
  SqliteStore& store = reopen();
  EXPECT_EQ(store.find("a")->title, "old");
  EXPECT_EQ(store.add(new_job("b", "{}", "key")), "b");
  close();
  EXPECT_EQ(database().execAndGet("PRAGMA user_version").getInt(), schema_version());
}

TEST_F(SqliteStoreTest, TakesOverSealedJobsOfBeforeThereWereTags) {
  for (const bool damaged : {false, true}) {
    close();
    std::filesystem::remove(file());
    {
      SQLite::Database old = connect(file());
      migrate(old, 4);
      old.exec(
          "INSERT INTO jobs (id, status, title, created, bytes) VALUES ('a', 'queued', 'old', 7, 0);"
          "UPDATE jobs SET seal = row_seal(id, status, title, created, started, finished, attempt, "
          "given_back,"
          "cancel_asked, verdict, bytes, trace, owner, ended, damaged)");
      if (damaged) old.exec("UPDATE jobs SET title = 'odd'");
      SQLite::Statement problem(old, "INSERT INTO problems VALUES ('a', ?)");
      const std::string packed = pack_text("{}");
      problem.bind(1, packed.data(), static_cast<int>(packed.size()));
      problem.exec();
    }
    SqliteStore& store = reopen();
    EXPECT_EQ(store.find("a")->status, damaged ? JobStatus::failed : JobStatus::queued);
    NewJob job = new_job("b");
    job.tags = {"t"};
    store.add(job);
    EXPECT_EQ(reopen().find("b")->tags, job.tags);
  }
}

/// What tags are looked up by follows from the rows, whatever became of it.
TEST_F(SqliteStoreTest, LooksTagsUpAnewAtEachStart) {
  NewJob job = new_job("a");
  job.tags = {"t", "u"};
  reopen().add(job);
  close();
  database().exec("DELETE FROM job_tags WHERE tag = x'74'; INSERT INTO job_tags VALUES (x'76', '', 'a')");
  SqliteStore& store = reopen();
  EXPECT_EQ(store.ids({.tag = "t"}), std::vector<std::string>{"a"});
  EXPECT_EQ(store.ids({.tag = "v"}), std::vector<std::string>{});
  close();
  // A row of which the tags are no longer what was written is damaged, and has none.
  database().exec("UPDATE jobs SET tags = '[\"w\"]'");
  EXPECT_EQ(reopen().find("a")->verdict.error->kind, "damaged");
  EXPECT_EQ(reopen().ids({.tag = "w"}), std::vector<std::string>{});
}

TEST_F(SqliteStoreTest, DoesNotTouchTheJobsOfANewerVersion) {
  reopen();
  close();
  database().exec("ALTER TABLE jobs ADD COLUMN later INTEGER; PRAGMA user_version = " +
                  std::to_string(schema_version() + 1));
  EXPECT_NE(reason_not_to_open().find("newer version"), std::string::npos);
}

/// The step that meets a fault changes nothing, and the next ones work when the fault is gone.
TEST_F(SqliteStoreTest, RefusesWhileTheDiskFailsAndRecovers) {
  for (const auto fault :
       {FaultyDisk::Fault::full, FaultyDisk::Fault::cannot_sync, FaultyDisk::Fault::cannot_access}) {
    SCOPED_TRACE(static_cast<int>(fault));
    for (int writes_before = 0; writes_before < 4; ++writes_before) {
      SqliteStore& store = reopen();
      const std::string id = std::to_string(static_cast<int>(fault)) + std::to_string(writes_before);
      store.add(new_job(id + "a"));
      const Claim claim = store.claim().value();
      EXPECT_FALSE(store.trouble());

      FaultyDisk::fail(fault, writes_before);
      EXPECT_THROW({ store.finish(claim, success(100'000)); }, StoreUnavailable);
      FaultyDisk::fail(fault);
      EXPECT_THROW(store.add(new_job(id + "b", "{}", id)), StoreUnavailable);
      EXPECT_THROW(store.cancel(id + "a"), StoreUnavailable);
      EXPECT_TRUE(store.trouble());

      FaultyDisk::fail(FaultyDisk::Fault::none);
      EXPECT_FALSE(store.trouble());
      EXPECT_EQ(store.find(id + "a")->status, JobStatus::running);
      EXPECT_FALSE(store.find(id + "b"));
      EXPECT_TRUE(store.finish(claim, success(100'000)));
      EXPECT_EQ(store.add(new_job(id + "b", "{}", id)), id + "b");
      store.finish(store.claim().value(), success());
      EXPECT_EQ(reopen().find(id + "a")->status, JobStatus::succeeded);
    }
  }
  close();
  EXPECT_EQ(database().execAndGet("PRAGMA integrity_check").getString(), "ok");
}

TEST_F(SqliteStoreTest, ASolveAloneCostsTwoSyncs) {
  SqliteStore& store = reopen();
  store.add(new_job("first"));
  store.finish(store.claim().value(), success());
  const int before = FaultyDisk::syncs();
  store.add(new_job("a"));
  store.finish(store.claim().value(), success(20'000));
  store.result("a");
  EXPECT_EQ(FaultyDisk::syncs() - before, 2);
}

TEST_F(SqliteStoreTest, OneSyncServesAllThatWait) {
  SqliteStore& store = reopen({10'000, plenty, std::chrono::hours(1)});
  FaultyDisk::slow_down(std::chrono::milliseconds(5));
  const int before = FaultyDisk::syncs();
  std::vector<std::thread> clients;
  std::atomic<int> refused = 0;
  constexpr int threads = 16, each = 20;
  for (int c = 0; c < threads; ++c) {
    clients.emplace_back([&store, &refused, c] {
      for (int i = 0; i < each; ++i) {
        const std::string id = std::to_string(c) + "-" + std::to_string(i);
        // Somebody else's refusal harms nobody in the same commit.
        store.add(new_job(id, "{}", id));
        try {
          store.add(new_job(id + "again", "{1}", id));
        } catch (const KeyReused&) {
          ++refused;
        }
      }
    });
  }
  for (std::thread& client : clients) client.join();
  FaultyDisk::slow_down(std::chrono::milliseconds(0));
  EXPECT_EQ(refused, threads * each);
  EXPECT_EQ(store.count()[JobStatus::queued], static_cast<std::size_t>(threads * each));
  // By itself each of them would cost one; checkpoints included.
  EXPECT_LT(FaultyDisk::syncs() - before, threads * each / 2);
}

TEST_F(SqliteStoreTest, AFullDiskIsFreedByDeleting) {
  const StoreLimits limits{100, plenty, std::chrono::hours(1)};
  SqliteStore& first = reopen(limits);
  for (const char* id : {"a", "b"}) {
    first.add(new_job(id));
    first.finish(first.claim().value(), success(3 << 20));
  }
  SqliteStore& store = reopen(limits);
  const auto size = std::filesystem::file_size(file());
  FaultyDisk::fail(FaultyDisk::Fault::no_room);
  int taken = 0;
  EXPECT_THROW(for (;; ++taken) store.add(new_job("more" + std::to_string(taken),
                                                  std::string(100'000, 'x') + std::to_string(std::rand()))),
               std::exception);
  EXPECT_TRUE(store.remove_ended("a"));
  EXPECT_FALSE(store.find("a"));
  EXPECT_EQ(store.find("b")->status, JobStatus::succeeded);
  FaultyDisk::fail(FaultyDisk::Fault::none);
  EXPECT_FALSE(store.trouble());
  for (int i = 0; i < 10; ++i) store.tidy();
  EXPECT_LT(std::filesystem::file_size(file()), size);
}

TEST_F(SqliteStoreTest, AFullDiskTakesOneDeletionAfterTheOther) {
  SqliteStore& store = reopen({100, plenty, std::chrono::hours(1)});
  constexpr int jobs = 12;
  for (int i = 0; i < jobs; ++i) {
    store.add(new_job(std::to_string(i)));
    store.finish(store.claim().value(), success(450'000));
  }
  FaultyDisk::fail(FaultyDisk::Fault::no_room);
  for (int i = 0; i < jobs; ++i) EXPECT_TRUE(store.remove_ended(std::to_string(i))) << i;
  FaultyDisk::fail(FaultyDisk::Fault::none);
}

TEST_F(SqliteStoreTest, AFullDiskLetsAKilledServiceStartAgain) {
  SqliteStore& store = reopen();
  store.add(new_job("ran"));
  store.claim();
  const TemporaryDirectory killed;
  for (const char* suffix : {"", "-wal"})
    std::filesystem::copy_file(file() + suffix, killed.path() + "/jobs.sqlite" + suffix);
  close();
  FaultyDisk::fail(FaultyDisk::Fault::no_room);
  {
    SqliteStore again(killed.path(), {100, plenty, std::chrono::hours(1)}, FaultyDisk::vfs());
    EXPECT_EQ(again.find("ran")->status, JobStatus::queued);
  }
  FaultyDisk::fail(FaultyDisk::Fault::none);
}

TEST_F(SqliteStoreTest, TheFileShrinksAgain) {
  SqliteStore& store = reopen();
  for (int i = 0; i < 5; ++i) {
    store.add(new_job(std::to_string(i)));
    store.finish(store.claim().value(), success(4 << 20));
  }
  close();
  const auto full = std::filesystem::file_size(file());
  EXPECT_GT(full, 15u << 20);
  SqliteStore& again = reopen();
  for (int i = 0; i < 5; ++i) again.remove_ended(std::to_string(i));
  for (int i = 0; i < 10; ++i) again.tidy();
  EXPECT_LT(std::filesystem::file_size(file()), full / 4);
}

/// In a name space of its own the daemon has a disk of 24 MB, which the test fills.
TEST(FullDisk, IsToldOfAndFreedByDeleting) {
  ChildProcess probe({"--version"}, {}, {"unshare", "--mount", "--map-root-user"});
  if (probe.wait(std::chrono::seconds(20)) != 0) GTEST_SKIP() << "no name spaces here";
  const TemporaryDirectory directory;
  const std::string disk = directory.path() + "/disk";
  std::filesystem::create_directory(disk);
  Daemon daemon({"--data-dir", disk + "/data"},
                {"unshare", "--mount", "--map-root-user", "sh", "-c",
                 "mount -t tmpfs -o size=24m tmpfs '" + disk + "' && exec \"$@\"", "sh"});
  const std::string seen_from_here = "/proc/" + std::to_string(daemon.process().id()) + "/root" + disk;
  if (!std::filesystem::exists(seen_from_here + "/data/jobs.sqlite")) GTEST_SKIP() << "cannot look into it";
  httplib::Client client("127.0.0.1", daemon.port());
  client.set_read_timeout(60);
  const auto reply =
      client.Post("/v1/solves?wait=60&fields=summary", problem_titled("small"), "application/json");
  ASSERT_EQ(reply->status, 200) << reply->body;
  const std::string id = nlohmann::json::parse(reply->body).at("id");
  EXPECT_EQ(client.Get("/readyz")->status, 200);

  std::ofstream filler(seen_from_here + "/filler");
  const std::string block(1 << 16, 'x');
  while (filler << block << std::flush) continue;
  filler.close();
  expect_problem(client.Get("/readyz"), 503);
  expect_problem(client.Post("/v1/solves", problem_titled("small"), "application/json"), 503);
  EXPECT_EQ(client.Delete("/v1/solves/" + id)->status, 204);
  EXPECT_EQ(client.Get("/v1/solves/" + id)->status, 404);
  std::filesystem::remove(seen_from_here + "/filler");
  EXPECT_EQ(client.Get("/readyz")->status, 200);
  EXPECT_EQ(client.Post("/v1/solves", problem_titled("small"), "application/json")->status, 202);
}

TEST_F(SqliteStoreTest, AReaderDoesNotWaitForAWriter) {
  SqliteStore& store = reopen();
  store.add(new_job("a"));
  store.add(new_job("b"));
  const Claim claim = store.claim().value();
  std::atomic<bool> written = false;
  std::thread writer([&] {
    store.finish(claim, success(std::size_t{100} << 20));
    written = true;
  });
  auto longest = std::chrono::steady_clock::duration::zero();
  while (!written) {
    const auto begin = std::chrono::steady_clock::now();
    store.find("b");
    longest = std::max(longest, std::chrono::steady_clock::now() - begin);
  }
  writer.join();
  EXPECT_LT(longest, std::chrono::milliseconds(sanitized ? 5000 : 250));
  EXPECT_EQ(store.result("a")->solution->displacement_at_points.size(), (100 << 20) / 8);
}

}  // namespace
}  // namespace signorini::server::sqlite_store_test
