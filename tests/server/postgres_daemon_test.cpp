// Several daemons with one database.

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <thread>

#include "becomes.hpp"
#include "example_problems.hpp"
#include "postgres_server.hpp"
#include "replica.hpp"

namespace signorini::server::postgres_daemon_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

std::string example(Replica& replica, const std::string& name) {
  return replica.get("/v1/examples/" + name)->body;
}

std::string id_in(const httplib::Result& reply) {
  EXPECT_EQ(reply->status, 202) << reply->body;
  return json::parse(reply->body).at("id");
}

TEST(PostgresFleet, EachAnswersForAll) {
  const std::string url = empty_database();
  Replica front(url, {"--role", "front"}), worker(url, {"--role", "worker"});
  const auto result = front.post(example(front, "paper-nonconforming"), "?wait=30&fields=summary");
  ASSERT_EQ(result->status, 200) << result->body;
  EXPECT_EQ(json::parse(result->body).at("summary").at("iterations"), 103);
  EXPECT_EQ(worker.get("/healthz")->status, 200);
  EXPECT_EQ(worker.get("/readyz")->status, 200);
  EXPECT_NE(worker.get("/metrics")->body.find("signorini_stale_writes_total 0"), std::string::npos);
  EXPECT_EQ(worker.get("/v1/solves")->status, 404);
}

TEST(PostgresFleet, EventsProgressAndCancellationCrossIt) {
  const std::string url = empty_database();
  Replica front(url, {"--role", "front"}), worker(url, {"--role", "worker"});
  const std::string id = id_in(front.post(endless_problem().dump()));
  ASSERT_TRUE(becomes([&] { return front.status_of(id).at("progress").at("iteration") > 0; }));
  EXPECT_EQ(front.status_of(id).at("status"), "running");
  const json listed = json::parse(front.get("/v1/solves")->body).at("solves").at(0);
  EXPECT_GT(listed.at("progress").at("iteration"), 0);
  std::string heard;
  std::thread listener([&] {
    httplib::Client client("127.0.0.1", front.port());
    client.set_read_timeout(60);
    client.Get("/v1/solves/" + id + "/events", [&](const char* data, std::size_t size) {
      heard.append(data, size);
      return true;
    });
  });
  std::this_thread::sleep_for(1500ms);
  EXPECT_EQ(front.remove(id)->status, 202);
  listener.join();
  EXPECT_NE(heard.find("event: progress\nid: "), std::string::npos) << heard.substr(0, 2000);
  EXPECT_NE(heard.find("event: cancelled"), std::string::npos);
  const json end = front.status_of(id);
  EXPECT_EQ(end.at("status"), "cancelled");
  // Every iteration was told, once and in order.
  std::size_t iterations = 0, place = 0;
  while ((place = heard.find("\"history\":{\"iteration\":", place)) != std::string::npos) {
    place += std::strlen("\"history\":{\"iteration\":");
    ASSERT_EQ(std::stoul(heard.substr(place)), ++iterations);
  }
  EXPECT_EQ(iterations, end.at("progress").at("iteration"));
}

TEST(PostgresFleet, WhatADyingOneRunsAnotherSolves) {
  const std::string url = empty_database();
  Replica front(url, {"--role", "front"});
  auto first = std::make_unique<Replica>(url, std::vector<std::string>{"--role", "worker"});
  const std::string id = id_in(front.post(endless_problem().dump()));
  ASSERT_TRUE(becomes([&] { return front.status_of(id).at("status") == "running"; }));
  const std::string started = front.status_of(id).at("started_at");
  first->process().signal(SIGKILL);
  const auto killed = std::chrono::steady_clock::now();
  Replica second(url, {"--role", "worker"});
  ASSERT_TRUE(becomes([&] {
    const json now = front.status_of(id);
    return now.at("status") == "running" && now.at("started_at") != started;
  }));
  EXPECT_LT(std::chrono::steady_clock::now() - killed, 2s + 5s);
  EXPECT_EQ(front.remove(id)->status, 202);
  EXPECT_TRUE(becomes([&] { return front.status_of(id).at("status") == "cancelled"; }));
}

TEST(PostgresFleet, OneThatSleepsLongerThanItsClaimWritesNothingMore) {
  const std::string url = empty_database();
  Replica front(url, {"--role", "front"}), sleeper(url, {"--role", "worker", "--workers", "1"});
  const std::string id = id_in(front.post(endless_problem().dump()));
  ASSERT_TRUE(becomes([&] { return front.status_of(id).at("status") == "running"; }));
  sleeper.process().signal(SIGSTOP);
  Replica other(url, {"--role", "worker", "--workers", "1"});
  const std::string other_runs = "job=" + id + " started";
  ASSERT_TRUE(
      becomes([&] { return other.process().standard_error().find(other_runs) != std::string::npos; }));
  sleeper.process().signal(SIGCONT);
  EXPECT_TRUE(becomes([&] {
    return sleeper.get("/metrics")->body.find("signorini_stale_writes_total 0") == std::string::npos;
  }));
  EXPECT_TRUE(becomes(
      [&] { return sleeper.process().standard_error().find("the claim is lost") != std::string::npos; }));
  EXPECT_EQ(front.status_of(id).at("status"), "running");
  EXPECT_EQ(front.remove(id)->status, 202);
  EXPECT_TRUE(becomes([&] { return front.status_of(id).at("status") == "cancelled"; }));
}

TEST(PostgresFleet, OneThatStopsLeavesItsSolvesToOthers) {
  const std::string url = empty_database();
  Replica front(url, {"--role", "front"}), first(url, {"--role", "worker", "--drain-seconds", "1"});
  const std::string id = id_in(front.post(endless_problem().dump()));
  ASSERT_TRUE(becomes([&] { return front.status_of(id).at("status") == "running"; }));
  first.process().signal(SIGTERM);
  EXPECT_EQ(first.process().wait(10s), 0);
  EXPECT_EQ(front.status_of(id).at("status"), "queued");
  Replica second(url, {"--role", "worker"});
  EXPECT_TRUE(becomes([&] { return front.status_of(id).at("status") == "running"; }));
}

TEST(PostgresFleet, WithoutTheDatabaseItWaitsAndSaysSo) {
  PostgresServer server;
  Replica replica(server.new_database("jobs"));
  const std::string problem = example(replica, "paper-nonconforming");
  const std::string id = id_in(replica.post(endless_problem().dump()));
  ASSERT_TRUE(becomes([&] { return replica.status_of(id).at("status") == "running"; }));
  server.end(SIGQUIT);
  const auto refused = replica.post(problem);
  EXPECT_EQ(refused->status, 503);
  // Where the database is concerns no client; the log says it.
  EXPECT_NE(refused->body.find("the database cannot be reached"), std::string::npos) << refused->body;
  EXPECT_NE(replica.process().standard_error().find("the database cannot be used: "), std::string::npos);
  EXPECT_EQ(replica.get("/readyz")->status, 503);
  EXPECT_EQ(replica.get("/healthz")->status, 200);
  EXPECT_TRUE(becomes([&] {
    return replica.process().standard_error().find("the claim is lost: the database is out of reach") !=
           std::string::npos;
  }));
  server.start();
  EXPECT_TRUE(becomes([&] { return replica.get("/readyz")->status == 200; }));
  EXPECT_EQ(replica.post(problem, "?wait=30")->status, 200);
  // The solve that was lost begins anew.
  EXPECT_TRUE(becomes([&] { return replica.status_of(id).at("status") == "running"; }));
}

TEST(PostgresFleet, HasTheMetricsThatAlertsAndTheDashboardAskFor) {
  Replica replica(empty_database());
  ASSERT_EQ(replica.post(example(replica, "paper-nonconforming"), "?wait=30")->status, 200);
  const std::string metrics = replica.get("/metrics")->body;
  static const std::regex name("(signorini|process)_[a-z_]+");
  for (const char* file : {"alerts.yaml", "dashboard.json"}) {
    std::ifstream stream(std::string(MONITORING) + "/" + file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    std::set<std::string> names;
    for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match)
      names.insert(match->str());
    EXPECT_GT(names.size(), 3u) << file;
    for (const std::string& each : names) {
      const bool is_there = metrics.find("\n" + each + " ") != std::string::npos ||
                            metrics.find("\n" + each + "{") != std::string::npos;
      EXPECT_TRUE(is_there) << file << " asks for " << each;
    }
  }
}

/// As the README says it.
TEST(PostgresFleet, IsBackedUpWhileItRunsAndBroughtBack) {
  const std::string url = empty_database(), empty = empty_database();
  std::string solved, running;
  {
    Replica replica(url, {"--workers", "1"});
    const auto result = replica.post(example(replica, "paper-nonconforming"), "?wait=30&fields=summary");
    solved = json::parse(result->body).at("id");
    running = id_in(replica.post(endless_problem().dump()));
    ASSERT_TRUE(becomes([&] { return replica.status_of(running).at("status") == "running"; }));
    const TemporaryDirectory directory;
    const std::string dump = directory.path() + "/solves.dump", programs = POSTGRES_PROGRAMS;
    ASSERT_EQ(std::system((programs + "/pg_dump --format=custom '" + url + "' > " + dump).c_str()), 0);
    ASSERT_EQ(std::system((programs + "/pg_restore --no-owner --dbname='" + empty + "' " + dump).c_str()), 0);
  }
  Replica replica(empty);
  EXPECT_EQ(replica.get("/v1/solves/" + solved + "/result")->status, 200);
  EXPECT_TRUE(becomes(
      [&] { return replica.process().standard_error().find(running + " started") != std::string::npos; }));
  EXPECT_EQ(replica.status_of(running).at("status"), "running");
  const std::string metrics = replica.get("/metrics")->body;
  EXPECT_NE(metrics.find("signorini_solves{status=\"succeeded\"} 1"), std::string::npos) << metrics;
}

TEST(PostgresFleet, OneThatCannotReachTheDatabaseSaysWhyWithoutThePassword) {
  ChildProcess process({"--port", "0", "--database", "postgresql://anne:secret@127.0.0.1:1/jobs"});
  EXPECT_EQ(process.wait(20s), 2);
  const std::string log = process.standard_error();
  EXPECT_NE(log.find("postgresql://anne@127.0.0.1:1/jobs (--database)"), std::string::npos) << log;
  EXPECT_EQ(log.find("secret"), std::string::npos) << log;
}

}  // namespace
}  // namespace signorini::server::postgres_daemon_test
