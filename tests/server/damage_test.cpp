// Bytes on the disk that are no longer what was written: they harm the solve that they belong to, and no
// other.

#include "becomes.hpp"
#include "running_service.hpp"

#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "server/jobs/sqlite/database.hpp"
#include "server/jobs/sqlite/repair.hpp"
#include "server/jobs/sqlite/schema.hpp"
#include "server/jobs/sqlite/store.hpp"
#include "store_jobs.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::damage_test {
namespace {

using nlohmann::json;

std::string content_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// --- through HTTP

class DamagedService : public testing::Test {
 protected:
  httplib::Client& start() {
    service_.reset();
    ServiceOptions options;
    options.data_dir = directory_.path();
    options.workers = 1;
    service_ = std::make_unique<RunningService>(options);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", service_->port());
    client_->set_read_timeout(100);
    return *client_;
  }

  std::string submit(const std::string& title) {
    return json::parse(client_->Post("/v1/solves", problem_titled(title), "application/json")->body).at("id");
  }

  json wait_for_end(const std::string& id) {
    json document;
    EXPECT_TRUE(becomes([&] {
      document = json::parse(client_->Get("/v1/solves/" + id)->body);
      return document.at("status") != "queued" && document.at("status") != "running";
    }));
    return document;
  }

  /// While the service runs.
  void damage(const std::string& sql, const std::string& id) {
    SQLite::Database raw(directory_.path() + "/jobs.sqlite", SQLite::OPEN_READWRITE, 5000);
    SQLite::Statement statement(raw, sql);
    statement.bind(1, id);
    EXPECT_EQ(statement.exec(), 1);
  }

  static void expect_damaged(const json& document, const std::string& what) {
    EXPECT_EQ(document.at("status"), "failed") << document;
    EXPECT_EQ(document.at("error").at("type"), "urn:signorini:problem:damaged") << document;
    EXPECT_NE(document.at("error").at("detail").get<std::string>().find(what), std::string::npos) << document;
  }

  /// So many solves are told of as damaged, and the service goes on.
  void expect_rest_goes_on(int damaged) {
    const auto ready = client_->Get("/readyz");
    EXPECT_EQ(ready->status, 200);
    EXPECT_EQ(json::parse(ready->body).at("damaged_solves"), damaged);
    EXPECT_NE(client_->Get("/metrics")->body.find("signorini_damaged_solves " + std::to_string(damaged)),
              std::string::npos);
    EXPECT_EQ(client_->Get("/v1/solves")->status, 200);
    EXPECT_EQ(wait_for_end(submit("instant")).at("status"), "succeeded");
  }

  TemporaryDirectory directory_;
  std::unique_ptr<RunningService> service_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(DamagedService, AProblemAtTheHeadOfTheQueueFailsAndTheNextOnesRun) {
  start();
  const std::string running = submit("slow");
  const std::string head = submit("instant"), next = submit("instant");
  damage("UPDATE problems SET text = zeroblob(length(text)) WHERE job = ?", head);
  client_->Delete("/v1/solves/" + running);
  expect_damaged(wait_for_end(head), "problem");
  EXPECT_EQ(wait_for_end(next).at("status"), "succeeded");
  expect_rest_goes_on(1);
  EXPECT_EQ(client_->Delete("/v1/solves/" + head)->status, 204);
  expect_rest_goes_on(0);
}

TEST_F(DamagedService, AVerdictHarmsNoList) {
  start();
  const std::string id = submit("instant");
  wait_for_end(id);
  damage("UPDATE jobs SET verdict = x'00ff00ff' WHERE id = ?", id);
  const auto list = client_->Get("/v1/solves");
  ASSERT_EQ(list->status, 200) << list->body;
  expect_damaged(json::parse(list->body).at("solves")[0], "entry");
  EXPECT_EQ(client_->Get("/v1/solves/" + id + "/result")->status, 410);
  start();
  expect_damaged(json::parse(client_->Get("/v1/solves/" + id)->body), "entry");
  expect_rest_goes_on(1);
}

TEST_F(DamagedService, AResultIsFoundOutWhenItIsRead) {
  start();
  const std::string id = submit("touches");
  EXPECT_EQ(wait_for_end(id).at("status"), "succeeded");
  damage(
      "UPDATE results SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || x'55' AS BLOB) WHERE job = ?",
      id);
  const json refusal = expect_problem(client_->Get("/v1/solves/" + id + "/result"), 410);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("not what was written"), std::string::npos)
      << refusal;
  expect_damaged(json::parse(client_->Get("/v1/solves/" + id)->body), "result");
  expect_rest_goes_on(1);
}

// --- flipped bits anywhere in the file

constexpr std::size_t page_bytes = 4096;

/// A store with jobs of every status and size, some deleted, closed again.
class DamagedFile : public testing::Test {
 protected:
  DamagedFile() {
    SqliteStore store(directory_.path(), limits_);
    std::mt19937 random(1);
    for (int i = 0; i < jobs_; ++i) {
      std::string problem = "{\"number\": " + std::to_string(i) + ", \"text\": \"";
      // Of which little can be compressed.
      for (std::size_t length = random() % 3000; problem.size() < length;)
        problem += static_cast<char>('a' + random() % 26);
      NewJob job = new_job(id_of(i), problem + "\"}",
                           i % 3 == 0 ? std::optional("key" + std::to_string(i)) : std::nullopt);
      job.title = "solve number " + std::to_string(i);
      job.owner = i % 2 == 0 ? "even" : "odd";
      if (i % 3 == 1) job.tags = {"third", "tag " + std::to_string(i)};
      store.add(job);
      if (i % 10 == 9) continue;
      const std::optional<Claim> claim = store.claim();
      store.finish(*claim, success(random() % 20'000));
    }
    for (int i = 0; i < jobs_; i += 7) store.remove_ended(id_of(i));
    for (const Job& job : all_of(store)) told_[job.id] = in_words(job);
  }

  static std::string id_of(int number) { return "01M83DT6YEMMMG2PZTSZ47" + std::to_string(1000 + number); }

  static std::string in_words(const Job& job) {
    std::ostringstream text;
    for (const std::string& tag : job.tags) text << tag << '|';
    text << name(job.status) << '|' << job.title << '|' << job.owner << '|' << iso8601(job.created) << '|'
         << (job.started ? iso8601(*job.started) : "") << '|' << (job.finished ? iso8601(*job.finished) : "")
         << '|' << (job.verdict.summary ? job.verdict.summary->iterations : -1);
    return text.str();
  }

  static std::vector<Job> all_of(const SqliteStore& store) {
    ListQuery query;
    query.limit = 1000;
    return store.list(query).jobs;
  }

  static bool is_damaged(const Job& job) {
    return job.status == JobStatus::failed && job.verdict.error && job.verdict.error->kind == "damaged";
  }

  /// Every job is what clients were told or says that it is damaged; none is missing, none new; and the store
  /// works. Returns how many are damaged.
  int expect_nothing_lost() {
    SqliteStore store(directory_.path(), limits_);
    std::map<std::string, std::string> found;
    int damaged = 0;
    for (const Job& job : all_of(store)) {
      EXPECT_TRUE(told_.contains(job.id)) << job.id << " was invented, or is back";
      found[job.id] = in_words(job);
      if (is_damaged(job)) {
        ++damaged;
      } else {
        EXPECT_EQ(found[job.id], told_[job.id]);
      }
      const auto result = store.result(job.id);
      EXPECT_TRUE(result) << job.id;
      if (job.status == JobStatus::succeeded && result && !result->solution) {
        EXPECT_TRUE(is_damaged(*store.find(job.id))) << job.id;
        ++damaged;
      }
    }
    for (const auto& [id, words] : told_) EXPECT_TRUE(found.contains(id)) << id << " is lost";
    const auto is_third = [&](const auto& each) { return each.second.starts_with("third|"); };
    EXPECT_EQ(store.ids({.tag = "third"}).size(), std::ranges::count_if(found, is_third));
    store.add(new_job("new"));
    int runs = 0;
    while (const auto claim = store.claim()) {
      EXPECT_TRUE(store.finish(*claim, success(5000)));
      ++runs;
    }
    EXPECT_GE(runs, 1);
    EXPECT_EQ(store.find("new")->status, JobStatus::succeeded);
    EXPECT_TRUE(store.remove_ended("new"));
    EXPECT_FALSE(store.trouble()) << *store.trouble();
    return damaged;
  }

  void put(const std::string& bytes) {
    for (const char* suffix : {"-wal", "-shm", ".damaged", ".damaged-wal"})
      std::filesystem::remove(file_ + suffix);
    write_file(file_, bytes);
  }

  static constexpr int jobs_ = 60;
  const StoreLimits limits_{1000, plenty, std::chrono::hours(24)};
  TemporaryDirectory directory_;
  const std::string file_ = directory_.path() + "/jobs.sqlite";
  std::map<std::string, std::string> told_;  ///< by id
};

TEST_F(DamagedFile, IsServedWhateverBitIsFlipped) {
  const std::string whole = content_of(file_);
  const std::size_t pages = whole.size() / page_bytes;
  ASSERT_GT(pages, 100u);
  std::mt19937 random(long_tests() ? std::random_device{}() : 5);
  // Each page of the first ones, where the roots and the heads are, then any; in its head, which holds most,
  // or anywhere.
  const int flips = long_tests() ? 5000 : (sanitized ? 40 : 90);
  int damaged_at_most = 0;
  for (int i = 0; i < flips; ++i) {
    const std::size_t page = i < 40 ? i : random() % pages;
    const std::size_t place = page * page_bytes + random() % (i % 2 == 0 ? 64 : page_bytes);
    const int bit = static_cast<int>(random() % 8);
    SCOPED_TRACE("byte " + std::to_string(place) + " bit " + std::to_string(bit));
    std::string bytes = whole;
    bytes[place] = static_cast<char>(bytes[place] ^ (1 << bit));
    put(bytes);
    damaged_at_most = std::max(damaged_at_most, expect_nothing_lost());
    if (HasFailure()) return;
  }
  // What is on one page.
  EXPECT_LE(damaged_at_most, 20);
}

TEST_F(DamagedFile, ServesWhatIsLeftOfOneThatWasCut) {
  const std::string whole = content_of(file_);
  for (const double part : {0.95, 0.6}) {
    put(whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    SqliteStore store(directory_.path(), limits_);
    int intact = 0;
    for (const Job& job : all_of(store)) {
      ASSERT_TRUE(told_.contains(job.id)) << job.id;
      if (is_damaged(job)) continue;
      EXPECT_EQ(in_words(job), told_[job.id]);
      ++intact;
    }
    EXPECT_GT(intact, 0);
    EXPECT_EQ(store.add(new_job("new")), "new");
  }
}

TEST_F(DamagedFile, IsMendedByTheCheck) {
  ChildProcess sound({"check", directory_.path()});
  EXPECT_EQ(sound.wait(std::chrono::seconds(60)), 0) << sound.standard_output();
  {
    SQLite::Database raw(file_, SQLite::OPEN_READWRITE);
    raw.exec("UPDATE results SET bytes = zeroblob(100) WHERE job = '" + id_of(2) + "'");
    raw.exec("UPDATE jobs SET title = 'other' WHERE id = '" + id_of(3) + "'");
    raw.exec("UPDATE problems SET text = x'00' WHERE job = '" + id_of(4) + "'");
  }
  ChildProcess damaged({"check", directory_.path()});
  EXPECT_EQ(damaged.wait(std::chrono::seconds(60)), 1);
  for (const int number : {2, 3, 4})
    EXPECT_NE(damaged.standard_output().find(id_of(number)), std::string::npos) << damaged.standard_output();
  ChildProcess mended({"check", directory_.path()});
  EXPECT_EQ(mended.wait(std::chrono::seconds(60)), 0) << mended.standard_output();
  EXPECT_EQ(expect_nothing_lost(), 3);

  ChildProcess nothing({"check", directory_.path() + "/nothing"});
  EXPECT_EQ(nothing.wait(std::chrono::seconds(60)), 2);
}

/// The files of a service that was killed: most of what it has promised is in the log.
class DamagedLog : public DamagedFile {
 protected:
  DamagedLog() {
    SqliteStore store(directory_.path(), limits_);
    // Not so many that SQLite begins the log anew, and leaves in it what nobody reads.
    constexpr int jobs_in_log = 25;
    for (int i = jobs_; i < jobs_ + jobs_in_log; ++i) {
      store.add(new_job(id_of(i), "{\"number\": " + std::to_string(i) + '}'));
      while (const auto claim = store.claim()) store.finish(*claim, success(500));
    }
    for (const Job& job : all_of(store)) told_[job.id] = in_words(job);
    whole_ = content_of(file_);
    log_ = content_of(file_ + "-wal");
  }

  void put_with_log(const std::string& log) {
    put(whole_);
    write_file(file_ + "-wal", log);
  }

  std::string whole_, log_;
};

TEST_F(DamagedLog, LosesNoSolveWhateverBitIsFlipped) {
  constexpr std::size_t log_head = 32, frame_bytes = 24 + page_bytes;
  ASSERT_GT(log_.size(), 100 * frame_bytes);
  put_with_log(log_);
  EXPECT_TRUE(repair(DataDir(directory_.path()), Depth::all).damage.empty());
  std::mt19937 random(long_tests() ? std::random_device{}() : 7);
  const int flips = long_tests() ? 1000 : (sanitized ? 10 : 30);
  for (int i = 0; i < flips; ++i) {
    // All but the last frame, which could be one that was not written to its end.
    std::size_t place = random() % (log_.size() - frame_bytes);
    if (i < 10) place = i < 5 ? random() % log_head : log_head + random() % 24;
    const int bit = static_cast<int>(random() % 8);
    SCOPED_TRACE("byte " + std::to_string(place) + " bit " + std::to_string(bit));
    std::string log = log_;
    log[place] = static_cast<char>(log[place] ^ (1 << bit));
    put_with_log(log);
    EXPECT_FALSE(repair(DataDir(directory_.path()), Depth::rows).damage.empty());
    SqliteStore store(directory_.path(), limits_);
    std::set<std::string> found;
    for (const Job& job : all_of(store)) {
      found.insert(job.id);
      // What is only known as it was before runs again.
      const bool may_differ = is_damaged(job) || job.status == JobStatus::queued;
      EXPECT_TRUE(may_differ || in_words(job) == told_[job.id]) << job.id;
    }
    for (const auto& [id, words] : told_) EXPECT_TRUE(found.contains(id)) << id << " is lost";
    if (HasFailure()) return;
  }
}

TEST_F(DamagedLog, IsNotWhatAKillLeaves) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    put_with_log(log_.substr(0, random() % log_.size()));
    EXPECT_TRUE(repair(DataDir(directory_.path()), Depth::all).damage.empty());
  }
}

TEST_F(DamagedLog, IsToldByTheCheck) {
  std::string log = log_;
  log[log.size() / 10] = static_cast<char>(log[log.size() / 10] ^ 1);
  put_with_log(log);
  ChildProcess check({"check", directory_.path()});
  EXPECT_EQ(check.wait(std::chrono::seconds(60)), 1);
  EXPECT_NE(check.standard_output().find("its log is not what was written"), std::string::npos)
      << check.standard_output();
}

}  // namespace
}  // namespace signorini::server::damage_test
