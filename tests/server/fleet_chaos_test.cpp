// A fleet whose services and database are killed, stopped and started again while clients post to it.

#include <atomic>
#include <csignal>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "postgres_server.hpp"
#include "replica.hpp"
#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::fleet_chaos_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using postgres::Values;
using Clock = std::chrono::steady_clock;

/// What the fleet does with its rows, as triggers see it: each end of a job...
constexpr const char* witness_of_ends = R"sql(
CREATE TABLE ends (job text, status text);
CREATE FUNCTION note_end() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN INSERT INTO ends VALUES (NEW.id, NEW.status); RETURN NULL; END $$;
CREATE TRIGGER note_end AFTER UPDATE OF finished ON jobs FOR EACH ROW WHEN (NEW.finished IS NOT NULL)
  EXECUTE FUNCTION note_end();
)sql";

/// ...and how late a silent runner lost his.
constexpr const char* witness_of_rescues = R"sql(
CREATE TABLE rescues (late bigint);
CREATE FUNCTION note_rescue() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  INSERT INTO rescues VALUES (clock_ms() - greatest(OLD.until,
    (extract(epoch FROM pg_postmaster_start_time()) * 1000)::bigint + 2000));
  RETURN NULL;
END $$;
CREATE TRIGGER note_rescue AFTER DELETE ON leases FOR EACH ROW WHEN (OLD.until < clock_ms())
  EXECUTE FUNCTION note_rescue();
)sql";

class Chaos {
 public:
  explicit Chaos(std::size_t replicas) : database_(server_.new_database("jobs")), replicas_(replicas) {
    for (auto& replica : replicas_) replica = make();
    // One transaction each: a trigger locks its table, and the services, which hold a row of one table when
    // they ask for the other, must never wait for a transaction that holds both.
    postgres::Connection connection(database_, 10s);
    connection.script(witness_of_ends);
    connection.script(witness_of_rescues);
  }

  /// Posts until it is taken in, wherever; what it is told meanwhile must be something that passes. Its id.
  std::string post(const std::string& problem, const std::string& key, std::mt19937& random) {
    for (const auto until = Clock::now() + 120s; Clock::now() < until;) {
      httplib::Client client("127.0.0.1", port(random()));
      client.set_read_timeout(20);
      const auto reply = client.Post("/v1/solves", {{"Idempotency-Key", key}}, problem, "application/json");
      if (reply && reply->status == 202) return json::parse(reply->body).at("id");
      if (reply) {
        EXPECT_EQ(reply->status, 503) << reply->body;
        EXPECT_TRUE(reply->has_header("Retry-After")) << reply->body;
      }
      std::this_thread::sleep_for(50ms);
    }
    ADD_FAILURE() << "nobody takes it in";
    return {};
  }

  void kill_one(std::mt19937& random) {
    const std::size_t one = random() % replicas_.size();
    note_stale_writes(one);
    const std::lock_guard lock(mutex_);
    replicas_[one]->process().signal(SIGKILL);
    replicas_[one] = make();
  }

  /// For longer than its claims are held.
  void stop_one_for_a_while(std::mt19937& random) {
    const std::size_t one = random() % replicas_.size();
    replicas_[one]->process().signal(SIGSTOP);
    std::this_thread::sleep_for(lease_of_replicas + 2s);
    replicas_[one]->process().signal(SIGCONT);
    std::this_thread::sleep_for(1500ms);
    note_stale_writes(one);
  }

  void restart_database(int signal) {
    server_.end(signal);
    std::this_thread::sleep_for(500ms);
    server_.start();
  }

  std::size_t stale_writes() {
    for (std::size_t i = 0; i < replicas_.size(); ++i) note_stale_writes(i);
    return stale_writes_;
  }

  postgres::Rows ask(const std::string& sql) { return postgres::Connection(database_, 30s).run(sql); }
  std::string example() { return replicas_.front()->get("/v1/examples/paper-nonconforming")->body; }

 private:
  std::unique_ptr<Replica> make() const {
    return std::make_unique<Replica>(database_,
                                     std::vector<std::string>{"--workers", "1", "--queue-limit", "100000"});
  }

  int port(std::size_t any) {
    const std::lock_guard lock(mutex_);
    return replicas_[any % replicas_.size()]->port();
  }

  /// Its counter begins anew with each process.
  void note_stale_writes(std::size_t one) {
    const auto metrics = replicas_[one]->get("/metrics");
    const std::string name = "\nsignorini_stale_writes_total ";
    if (!metrics || metrics->body.find(name) == std::string::npos) return;
    const auto count = std::stoul(metrics->body.substr(metrics->body.find(name) + name.size()));
    std::size_t& known = known_[replicas_[one]->port()];
    stale_writes_ += count - std::min<std::size_t>(known, count);
    known = count;
  }

  PostgresServer server_;
  const std::string database_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Replica>> replicas_;
  std::map<int, std::size_t> known_;
  std::size_t stale_writes_ = 0;
};

TEST(PostgresChaos, EachJobEndsOnceWhateverIsKilled) {
  const std::size_t jobs = long_tests() ? 10'000 : sanitized ? 40 : 150;
  constexpr std::size_t clients = 3;
  Chaos chaos(long_tests() ? 4 : 3);
  json problem = json::parse(chaos.example());
  std::atomic<std::size_t> posted = 0;
  std::mutex mutex;
  std::set<std::string> acknowledged;
  std::vector<std::thread> posting;
  for (std::size_t client = 0; client < clients; ++client)
    posting.emplace_back([&, client] {
      std::mt19937 random(static_cast<unsigned>(client));
      for (std::size_t i = posted++; i < jobs; i = posted++) {
        json own = problem;
        // A tenth of a second or so; ten thousand of them a quarter of that.
        const std::size_t squares = sanitized ? 10 : long_tests() ? 16 : 40;
        own["mesh"]["divisions"] = {squares + i % 40, squares};
        own["solver"]["rho"] = 0.02;
        own["solver"]["max_iterations"] = 20'000;
        const std::string id = chaos.post(own.dump(), "key-" + std::to_string(i), random);
        const std::lock_guard lock(mutex);
        acknowledged.insert(id);
      }
    });
  const auto ended = [&] {
    return static_cast<std::size_t>(chaos.ask("SELECT count(DISTINCT job) FROM ends").integer(0, 0));
  };
  std::mt19937 random(7);
  const int signals[] = {SIGQUIT, SIGKILL, SIGINT};
  int restarts = 0, round = 0;
  const auto begin = Clock::now();
  // Bounded, for a machine that has other things to do makes no way between two kills; and until the fence
  // was needed.
  const auto longest = long_tests() ? 2400s : sanitized ? 40s : 120s;
  const auto goes_on = [&] {
    return ended() < jobs && Clock::now() - begin < longest &&
           (long_tests() || round < 6 || chaos.stale_writes() == 0);
  };
  while (goes_on()) {
    ++round;
    std::this_thread::sleep_for(2s);
    chaos.kill_one(random);
    if (round % 4 == 1) chaos.stop_one_for_a_while(random);
    const bool is_time = round == 2 || (long_tests() && restarts < 3 &&
                                        ended() > jobs * static_cast<std::size_t>(restarts) / 3);
    if (is_time) chaos.restart_database(signals[restarts++ % 3]);
  }
  for (std::thread& thread : posting) thread.join();
  for (const auto calm = Clock::now(); ended() < jobs && Clock::now() - calm < 600s;)
    std::this_thread::sleep_for(200ms);
  const std::chrono::duration<double> time = Clock::now() - begin;
  EXPECT_EQ(acknowledged.size(), jobs);
  EXPECT_EQ(ended(), jobs);
  EXPECT_EQ(chaos.ask("SELECT FROM ends GROUP BY job HAVING count(*) > 1").size(), 0);
  EXPECT_EQ(chaos.ask("SELECT FROM jobs").size(), static_cast<int>(jobs));
  EXPECT_EQ(chaos.ask("SELECT FROM queue UNION ALL SELECT FROM leases").size(), 0);
  EXPECT_EQ(chaos
                .ask("SELECT FROM jobs WHERE status = 'succeeded' AND NOT EXISTS "
                     "(SELECT FROM results WHERE job = id AND results.attempt = jobs.attempt)")
                .size(),
            0);
  const postgres::Rows statuses =
      chaos.ask("SELECT status, count(*) FROM jobs GROUP BY status ORDER BY status");
  for (int row = 0; row < statuses.size(); ++row)
    std::cout << statuses.text(row, 0) << ": " << statuses.integer(row, 1) << "\n";
  // Only attempts that were used up may fail a job.
  EXPECT_EQ(chaos.ask("SELECT FROM jobs WHERE status NOT IN ('succeeded', 'failed')").size(), 0);
  EXPECT_EQ(chaos.ask("SELECT FROM jobs WHERE status = 'failed' AND attempt - given_back < 3").size(), 0);
  const postgres::Rows rescues = chaos.ask("SELECT count(*), coalesce(max(late), 0) FROM rescues");
  EXPECT_LE(rescues.integer(0, 1), 5000);
  if (!sanitized) {
    EXPECT_GT(chaos.stale_writes(), 0u);
  }
  std::cout << jobs << " jobs in " << time.count() << " s, " << round << " kills, " << restarts
            << " restarts of the database, " << rescues.integer(0, 0) << " rescues, the latest "
            << rescues.integer(0, 1) << " ms after the claim was over, " << chaos.stale_writes()
            << " stale writes refused\n";
}

}  // namespace
}  // namespace signorini::server::fleet_chaos_test
