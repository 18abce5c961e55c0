// kill -9 at random moments under load: what the service has promised holds.

#include "running_service.hpp"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>

#include <SQLiteCpp/SQLiteCpp.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "example_problems.hpp"
#include "server/jobs/sqlite/store.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::crash_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

/// 20, or 1000 in the long form.
int kills() {
  return long_tests() ? 1000 : sanitized ? 8 : 20;
}

/// Takes a millisecond, or some tens of them, so that some solves run whenever the service is killed.
std::string problem(bool large) {
  return paper_problem(large ? 48 : 4).dump();
}

/// What the clients were told of one solve.
struct Told {
  std::string key;
  bool large = false;
  bool delete_sent = false;
  bool delete_confirmed = false;
  json ending;  ///< the status document that first showed it ended
};

/// What the clients were told at all.
class Ledger {
 public:
  void accepted(const std::string& id, const std::string& key, bool large) {
    const std::lock_guard lock(mutex_);
    told_[id].key = key;
    told_[id].large = large;
  }

  Told of(const std::string& id) {
    const std::lock_guard lock(mutex_);
    return told_[id];
  }

  /// A solve to look at or to delete; empty if there is none.
  std::string any(std::mt19937& random) {
    const std::lock_guard lock(mutex_);
    if (told_.empty()) return "";
    // Mostly a young one: those change.
    const std::size_t back =
        std::min<std::size_t>(told_.size(), 1 + random() % (random() % 8 == 0 ? 1000 : 8));
    return std::prev(told_.end(), static_cast<std::ptrdiff_t>(back))->first;
  }

  void deleting(const std::string& id) {
    const std::lock_guard lock(mutex_);
    told_[id].delete_sent = true;
  }
  void deleted(const std::string& id) {
    const std::lock_guard lock(mutex_);
    told_[id].delete_confirmed = true;
  }

  /// The service shows this status document, or 404 if there is none, to a client that was told so much
  /// before it asked.
  void seen(const std::string& id, const Told& before, const std::optional<json>& document) {
    const std::lock_guard lock(mutex_);
    Told& told = told_[id];
    if (!document) {
      EXPECT_TRUE(told.delete_sent) << id << " is lost";
      return;
    }
    EXPECT_FALSE(before.delete_confirmed) << id << " is back after it was deleted";
    if (!before.ending.is_null()) {
      EXPECT_EQ(*document, before.ending) << id << " has changed after its end";
    }
    const std::string status = document->at("status");
    if (status == "queued" || status == "running") return;
    told.ending = *document;
    if (status == "failed") {
      EXPECT_EQ(document->at("error").at("type"), "urn:signorini:problem:attempts-used-up") << *document;
    }
  }

  const std::map<std::string, Told>& told() const { return told_; }

  /// The clients have heard one more reply.
  void heard() { ++replies_; }
  int replies() const { return replies_; }

 private:
  std::atomic<int> replies_ = 0;
  std::mutex mutex_;
  std::map<std::string, Told> told_;
};

void submit(httplib::Client& client, Ledger& ledger, bool large) {
  static std::atomic<int> keys = 0;
  const std::string key = "key-" + std::to_string(++keys);
  const auto reply =
      client.Post("/v1/solves", {{"Idempotency-Key", key}}, problem(large), "application/json");
  if (reply && reply->status == 202) ledger.accepted(json::parse(reply->body).at("id"), key, large);
}

void submit_again(httplib::Client& client, Ledger& ledger, const std::string& id) {
  const Told told = ledger.of(id);
  const auto reply =
      client.Post("/v1/solves", {{"Idempotency-Key", told.key}}, problem(told.large), "application/json");
  if (!reply || reply->status != 202) return;
  const std::string answered = json::parse(reply->body).at("id");
  if (answered == id) return;
  EXPECT_TRUE(ledger.of(id).delete_sent) << id << " would be solved a second time as " << answered;
  ledger.accepted(answered, told.key, told.large);
}

void look(httplib::Client& client, Ledger& ledger, const std::string& id) {
  const Told before = ledger.of(id);
  const auto reply = client.Get("/v1/solves/" + id);
  if (!reply) return;
  if (reply->status == 200) ledger.seen(id, before, json::parse(reply->body));
  if (reply->status == 404) ledger.seen(id, before, std::nullopt);
}

void remove(httplib::Client& client, Ledger& ledger, const std::string& id) {
  ledger.deleting(id);
  const auto reply = client.Delete("/v1/solves/" + id);
  if (reply && reply->status == 204) ledger.deleted(id);
}

/// Submits, looks and deletes until the service is gone.
void use(int port, Ledger& ledger, unsigned seed, const std::atomic<bool>& killed) {
  httplib::Client client("127.0.0.1", port);
  client.set_keep_alive(true);
  client.set_tcp_nodelay(true);
  std::mt19937 random(seed);
  while (!killed) {
    const auto action = static_cast<unsigned>(random() % 9);
    const std::string id = ledger.any(random);
    if (action < 3 || id.empty()) {
      submit(client, ledger, action == 0);
    } else if (action == 3) {
      submit_again(client, ledger, id);
    } else if (action < 7) {
      look(client, ledger, id);
    } else {
      remove(client, ledger, id);
    }
    if (!killed) ledger.heard();
  }
}

void check_all(int port, Ledger& ledger, bool results_too) {
  httplib::Client client("127.0.0.1", port);
  client.set_keep_alive(true);
  client.set_tcp_nodelay(true);
  for (const auto& [id, told] : std::map(ledger.told())) {
    look(client, ledger, id);
    const json ending = ledger.of(id).ending;
    if (!results_too || ending.is_null() || told.delete_sent || ending.at("status") != "succeeded") continue;
    const auto result = client.Get("/v1/solves/" + id + "/result");
    ASSERT_TRUE(result) << id;
    ASSERT_EQ(result->status, 200) << result->body;
    EXPECT_EQ(json::parse(result->body).at("summary"), ending.at("summary"));
  }
}

void wait_until_idle(int port) {
  httplib::Client client("127.0.0.1", port);
  const auto until = Clock::now() + 300s;
  for (const char* status : {"queued", "running"}) {
    while (!json::parse(client.Get(std::string("/v1/solves?status=") + status)->body).at("solves").empty()) {
      ASSERT_LT(Clock::now(), until);
      std::this_thread::sleep_for(10ms);
    }
  }
}

TEST(Crash, LosesNothingThatWasPromised) {
  const TemporaryDirectory directory;
  const std::vector<std::string> flags{"--data-dir", directory.path(), "--queue-limit",
                                       "100000",     "--keep-bytes",   "100gb"};
  Ledger ledger;
  std::mt19937 random(std::random_device{}());
  for (int i = 0; i < kills(); ++i) {
    Daemon daemon(flags);
    ASSERT_NE(daemon.port(), 0);
    // The whole book now and then, the young pages always.
    if (i % 10 == 0) check_all(daemon.port(), ledger, false);
    std::atomic<bool> killed = false;
    std::vector<std::thread> clients;
    for (int c = 0; c < 4; ++c) {
      clients.emplace_back(use, daemon.port(), std::ref(ledger), static_cast<unsigned>(random()),
                           std::cref(killed));
    }
    // A life is counted in replies, so that a slow machine or a sanitizer tests as much as a fast one.
    const int last = ledger.replies() + static_cast<int>(20 + random() % 40);
    while (ledger.replies() < last) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    daemon.process().signal(SIGKILL);
    killed = true;
    for (std::thread& client : clients) client.join();
    ASSERT_FALSE(HasFailure()) << "after kill " << i + 1;
  }
  Daemon daemon(flags);
  wait_until_idle(daemon.port());
  check_all(daemon.port(), ledger, true);
  // Every promise was worth something: some solves ended, were deleted, and were cut short.
  std::map<std::string, int> count;
  for (const auto& [id, told] : ledger.told()) {
    ++count[told.delete_confirmed   ? "deleted"
            : told.ending.is_null() ? "gone"
                                    : told.ending.at("status").get<std::string>()];
  }
  for (const auto& [what, number] : count) RecordProperty(what, number);
  EXPECT_GT(count["succeeded"], 0);
  EXPECT_GT(count["deleted"], 0);

  daemon.process().signal(SIGKILL);
  daemon.process().wait(5s);
  SQLite::Database database(directory.path() + "/jobs.sqlite", SQLite::OPEN_READWRITE);
  EXPECT_EQ(database.execAndGet("PRAGMA integrity_check").getString(), "ok");
  EXPECT_EQ(
      database.execAndGet("SELECT count(*) FROM results WHERE job NOT IN (SELECT id FROM jobs)").getInt(), 0);
}

TEST(Crash, BootsSoonWithManyJobs) {
  const TemporaryDirectory directory;
  { const SqliteStore empty(directory.path(), {}); }
  {
    SQLite::Database database(directory.path() + "/jobs.sqlite", SQLite::OPEN_READWRITE);
    database.exec(
        "BEGIN;"
        "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 100000)"
        "INSERT INTO jobs (id, status, title, created, started, finished, attempt, bytes)"
        "SELECT printf('%026d', i), CASE WHEN i % 100 = 0 THEN 'queued' WHEN i % 100 = 1 THEN 'running'"
        "  ELSE 'cancelled' END, 'job ' || i, 1e12 + i, 1e12 + i,"
        "  iif(i % 100 > 1, unixepoch() * 1000, NULL), i % 100 > 0, 5000 FROM n;"
        "INSERT INTO problems SELECT id, randomblob(1000) FROM jobs;"
        "INSERT INTO results SELECT id, 0, randomblob(4000) FROM jobs WHERE finished IS NOT NULL;"
        "COMMIT");
  }
  const auto begin = Clock::now();
  Daemon daemon({"--data-dir", directory.path(), "--queue-limit", "10000"});
  httplib::Client client("127.0.0.1", daemon.port());
  EXPECT_EQ(client.Get("/readyz")->status, 200);
  EXPECT_LT(Clock::now() - begin, sanitized ? 20s : 2s);
  EXPECT_EQ(json::parse(client.Get("/v1/solves?limit=1000")->body).at("solves").size(), 1000u);
}

}  // namespace
}  // namespace signorini::server::crash_test
