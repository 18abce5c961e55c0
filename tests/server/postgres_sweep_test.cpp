// A long sweep on several machines: the same answer as on one, whoever dies meanwhile.

#include <csignal>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "becomes.hpp"
#include "example_problems.hpp"
#include "postgres_server.hpp"
#include "replica.hpp"
#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::postgres_sweep_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// Of gaps whose shapes differ, so that each is solved anew: some hundredths of a second.
json sweep_of_gaps(int entries, int squares) {
  json problem = example("elastic-block");
  problem["title"] = "many gaps";
  problem["mesh"]["divisions"] = {2 * squares, squares};
  for (int i = 0; i < entries; ++i)
    problem["sweep"].push_back(
        {{"title", "gap " + std::to_string(i)},
         {"boundary", {{"bottom", {{"gap", std::to_string(0.01 + 1e-5 * i) + " * x^2"}}}}}});
  return problem;
}

/// The result without what tells of time and memory.
json answer_of(const std::string& text) {
  json result = json::parse(text);
  result.erase("id");
  json& summary = result.at("summary");
  for (const char* const member : {"timings", "peak_memory_bytes", "reused"}) summary.erase(member);
  for (json& entry : result.at("sweep"))
    if (entry.contains("summary")) entry.at("summary").erase("seconds");
  if (result.contains("history")) result.at("history").erase("seconds");
  return result;
}

class Fleet {
 public:
  explicit Fleet(std::size_t replicas) {
    while (replicas_.size() < replicas) replicas_.push_back(make());
    postgres::Connection(database_, 10s)
        .script(
            "CREATE TABLE chunk_ends (job text, attempt bigint); "
            "CREATE FUNCTION note_chunk() RETURNS trigger LANGUAGE plpgsql AS "
            "$$ BEGIN INSERT INTO chunk_ends VALUES (NEW.id, NEW.attempt); RETURN NULL; END $$; "
            "CREATE TRIGGER note_chunk AFTER UPDATE OF finished ON jobs FOR EACH ROW "
            "WHEN (NEW.finished IS NOT NULL AND NEW.whole IS NOT NULL) EXECUTE FUNCTION note_chunk()");
  }

  Replica& operator[](std::size_t number) { return *replicas_[number]; }
  std::size_t size() const { return replicas_.size(); }
  void kill(std::size_t number) {
    replicas_[number]->process().signal(SIGKILL);
    replicas_[number] = make();
  }
  postgres::Rows ask(const std::string& sql) { return postgres::Connection(database_, 10s).run(sql); }
  std::int64_t count(const std::string& sql) { return ask("SELECT count(*) FROM " + sql).integer(0, 0); }
  /// How many had chunks to run besides the one that had the whole.
  int helpers(const std::string& id) {
    int count = 0;
    for (const auto& replica : replicas_)
      count += replica->process().standard_error().find("job=" + id + "C") != std::string::npos;
    return count;
  }
  bool has_ended(const std::string& id) {
    const std::string status = status_of(id).value("status", "");
    return status != "queued" && status != "running" && !status.empty();
  }
  json status_of(const std::string& id) {
    const auto reply = replicas_.front()->get("/v1/solves/" + id);
    return reply && reply->status == 200 ? json::parse(reply->body) : json::object();
  }

 private:
  std::unique_ptr<Replica> make() const {
    return std::make_unique<Replica>(database_, std::vector<std::string>{"--workers", "1"});
  }

  const std::string database_ = empty_database();
  std::vector<std::unique_ptr<Replica>> replicas_;
};

/// What a service without a fleet answers.
json answer_of_one(const json& problem) {
  Daemon alone({"--data-dir", ":memory:", "--workers", "1"});
  httplib::Client client("127.0.0.1", alone.port());
  client.set_read_timeout(600);
  const auto reply = client.Post("/v1/solves?wait=600", problem.dump(), "application/json");
  return answer_of(reply->body);
}

constexpr int entries = sanitized ? 60 : 300;
constexpr int squares = sanitized ? 4 : 12;

TEST(PostgresSweep, IsSolvedByAllAsByOne) {
  json problem = sweep_of_gaps(entries, squares);
  // One that has no solution fails alone.
  problem["sweep"][entries - 2]["boundary"]["top"]["pressure"] = -1;
  Fleet fleet(3);
  const std::string id = json::parse(fleet[0].post(problem.dump())->body).at("id");
  std::size_t swept = 0;
  EXPECT_TRUE(becomes(
      [&] {
        const json progress = fleet.status_of(id).value("progress", json::object());
        if (progress.is_object() && progress.contains("sweep"))
          swept = std::max(swept, progress.at("sweep").value("done", std::size_t{0}));
        return fleet.has_ended(id);
      },
      300s));
  std::cout << fleet.count("chunk_ends") << " chunks, " << swept << " entries seen to be done\n";
  EXPECT_GT(swept, 0u);
  EXPECT_GT(fleet.count("chunk_ends"), 2);
  EXPECT_GE(fleet.helpers(id), 1);
  EXPECT_EQ(fleet.count("jobs"), 1);
  EXPECT_EQ(fleet.count("queue") + fleet.count("leases"), 0);
  EXPECT_EQ(answer_of(fleet[1].get("/v1/solves/" + id + "/result")->body), answer_of_one(problem));
}

TEST(PostgresSweep, EndsWithTheWhole) {
  Fleet fleet(2);
  const json problem = sweep_of_gaps(5000, squares);
  const std::string id = json::parse(fleet[0].post(problem.dump())->body).at("id");
  ASSERT_TRUE(becomes([&] { return fleet.count("leases") >= 3; }, 60s));
  fleet[1].remove(id);
  EXPECT_TRUE(becomes([&] { return fleet.status_of(id)["status"] == "cancelled"; }, 10s));
  // And nobody works on it any more.
  EXPECT_TRUE(becomes([&] { return fleet.count("jobs") == 1 && fleet.count("leases") == 0; }, 5s));
  const auto waited = fleet[1].post(sweep_of_gaps(1, 2).dump(), "?wait=20");
  EXPECT_EQ(waited->status, 200);
}

/// The same answer, whoever is killed in mid-chunk, him with the whole too.
TEST(PostgresSweep, SurvivesThoseWhoSolveIt) {
  const json problem = sweep_of_gaps(long_tests() ? 5000 : 2 * entries, squares);
  Fleet fleet(3);
  const std::string id = json::parse(fleet[0].post(problem.dump())->body).at("id");
  ASSERT_TRUE(becomes([&] { return fleet.count("jobs WHERE whole IS NOT NULL") > 0; }, 60s));
  std::mt19937 random(5);
  for (int kills = 0; kills < (long_tests() ? 12 : 2) && !fleet.has_ended(id); ++kills) {
    std::this_thread::sleep_for(1s);
    fleet.kill(random() % fleet.size());
    // So that no chunk is lost three times.
    std::this_thread::sleep_for(lease_of_replicas + 1s);
  }
  EXPECT_TRUE(becomes([&] { return fleet.has_ended(id); }, long_tests() ? 1200s : 300s));
  EXPECT_EQ(fleet.count("jobs"), 1);
  EXPECT_EQ(fleet.count("queue") + fleet.count("leases"), 0);
  std::cout << fleet.count("chunk_ends") << " chunks, " << fleet.count("chunk_ends WHERE attempt > 1")
            << " of them after somebody died\n";
  EXPECT_EQ(answer_of(fleet[0].get("/v1/solves/" + id + "/result")->body), answer_of_one(problem));
}

/// Seconds of cores that a process has taken.
double core_seconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string field;
  for (int skipped = 0; skipped < 11; ++skipped) fields >> field;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Where there is not a core for each, what the busiest one takes stands for the time on machines of their
/// own: nobody waits for anything but the last chunk.
TEST(PostgresSweep, OnThreeMachinesTakesLittleMoreThanAThird) {
  if (!long_tests()) GTEST_SKIP() << "has no bounds for less";
  const json problem = sweep_of_gaps(10'000, squares);
  struct Run {
    double seconds, busiest;
    json answer;
  };
  const auto run = [&](std::size_t replicas) {
    Fleet fleet(replicas);
    std::vector<double> before;
    for (std::size_t i = 0; i < replicas; ++i) before.push_back(core_seconds(fleet[i].process().id()));
    const auto begin = Clock::now();
    const std::string id = json::parse(fleet[0].post(problem.dump())->body).at("id");
    EXPECT_TRUE(becomes([&] { return fleet.has_ended(id); }, 3000s));
    Run found{Seconds(Clock::now() - begin).count(), 0, {}};
    for (std::size_t i = 0; i < replicas; ++i)
      found.busiest = std::max(found.busiest, core_seconds(fleet[i].process().id()) - before[i]);
    found.answer = answer_of(fleet[0].get("/v1/solves/" + id + "/result")->body);
    return found;
  };
  const Run one = run(1), three = run(3);
  std::cout << "one: " << one.seconds << " s, of a core " << one.busiest << " s; three: " << three.seconds
            << " s, of a core each at most " << three.busiest << " s\n";
  EXPECT_EQ(one.answer, three.answer);
  EXPECT_LT(three.busiest, 0.45 * one.busiest);
  if (std::thread::hardware_concurrency() >= 4) {
    EXPECT_LT(three.seconds, 0.45 * one.seconds);
  }
}

}  // namespace
}  // namespace signorini::server::postgres_sweep_test
