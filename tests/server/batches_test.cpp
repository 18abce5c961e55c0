// Many problems in one request, and their results in one reply.

#include "becomes.hpp"
#include "running_service.hpp"

#include <csignal>
#include <fstream>
#include <set>
#include <thread>

#include "child_process.hpp"
#include "example_problems.hpp"
#include "process_figures.hpp"
#include "raw_client.hpp"
#include "reply_reader.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::batches_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr int kQueueLimit = 20;

json batch_of(const std::vector<std::string>& titles) {
  json batch{{"title", "many"}, {"tags", {"b"}}};
  for (const std::string& title : titles) batch["problems"].push_back(json::parse(problem_titled(title)));
  return batch;
}

std::vector<json> lines_of(const std::string& text) {
  std::vector<json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

/// Both stores.
class Batches : public testing::TestWithParam<bool> {
 protected:
  Batches() { start(); }

  void start(std::size_t max_body_bytes = 1 << 20) {
    client_.reset();
    service_.reset();
    ServiceOptions options;
    options.queue_limit = kQueueLimit;
    options.limits.max_body_bytes = max_body_bytes;
    options.max_subscribers = 3;
    if (GetParam()) options.data_dir = directory_.path();
    service_ = std::make_unique<RunningService>(options);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", service_->port());
    client_->set_read_timeout(100);
  }

  httplib::Result post(const json& batch, const httplib::Headers& headers = {}) {
    return client_->Post("/v1/batches", headers, batch.dump(), "application/json");
  }
  json accepted(const json& batch, const httplib::Headers& headers = {}) {
    const auto reply = post(batch, headers);
    EXPECT_EQ(reply->status, 202) << reply->body;
    return json::parse(reply->body);
  }
  httplib::Result get(const std::string& path, const httplib::Headers& headers = {}) {
    return client_->Get(path, headers);
  }
  json status_of(const json& batch) { return json::parse(get(batch.at("links").at("self"))->body); }
  std::string results_of(const json& batch, const std::string& query = "?fields=summary") {
    const auto reply = get(std::string(batch.at("links").at("results")) + query);
    EXPECT_EQ(reply->status, 200);
    return reply->body;
  }
  std::size_t solves() { return json::parse(get("/v1/solves?limit=1000")->body).at("solves").size(); }
  void wait_for_running(std::size_t count) {
    EXPECT_TRUE(becomes([&] {
      return json::parse(get("/v1/solves?status=running")->body).at("solves").size() == count;
    })) << count;
  }
  RawClient listener_to(const json& batch, const std::string& query = "?fields=summary") {
    RawClient client(service_->port());
    client.send("GET " + std::string(batch.at("links").at("results")) + query +
                " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return client;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<RunningService> service_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_P(Batches, AreAcceptedWithTheIdsOfTheirSolves) {
  const auto reply = post(batch_of({"instant", "touches", "no solution", "diverges"}));
  ASSERT_EQ(reply->status, 202) << reply->body;
  const json batch = json::parse(reply->body);
  const std::string id = batch.at("id");
  EXPECT_EQ(reply->get_header_value("Location"), "/v1/batches/" + id);
  ASSERT_EQ(batch.at("solves").size(), 4u);
  const std::vector<json> results = lines_of(results_of(batch, ""));
  ASSERT_EQ(results.size(), 4u);
  std::map<std::string, json> by_id;
  for (const json& result : results) by_id[result.at("id")] = result;
  EXPECT_EQ(by_id.at(batch.at("solves")[0]).at("problem").at("title"), "instant");
  EXPECT_EQ(by_id.at(batch.at("solves")[0]).at("history").at("iteration").size(), 3u);
  EXPECT_EQ(by_id.at(batch.at("solves")[1]).at("contact").at("floor").at("pressure"), json({2.5}));
  EXPECT_EQ(by_id.at(batch.at("solves")[2]).at("error").at("detail"), "nothing holds the body");
  EXPECT_EQ(by_id.at(batch.at("solves")[3]).at("summary").at("outcome"), "diverged");
  const json status = status_of(batch);
  EXPECT_EQ(
      status.at("counts"),
      (json{
          {"queued", 0}, {"running", 0}, {"succeeded", 2}, {"failed", 2}, {"cancelled", 0}, {"deleted", 0}}));
  EXPECT_EQ(status.at("count"), 4);
  EXPECT_EQ(status.at("solves"), batch.at("solves"));
  EXPECT_EQ(status.at("title"), "many");
  // Its tags are those of its solves, and the list has them as any other.
  const json listed = json::parse(get("/v1/solves?tag=b")->body).at("solves");
  ASSERT_EQ(listed.size(), 4u);
  EXPECT_EQ(listed[3].at("id"), batch.at("solves")[0]);
  expect_problem(get("/v1/batches/" + std::string(26, '0')), 404);
  expect_problem(get("/v1/batches/" + std::string(batch.at("solves")[0])), 404);
}

TEST_P(Batches, SendResultsAsSolvesEnd) {
  const json batch = accepted(batch_of({"slow", "instant", "short", "instant"}));
  std::vector<RawClient> client;
  client.push_back(listener_to(batch));
  const auto lines_heard = [&] { return std::ranges::count(client[0].heard(), '\n'); };
  const auto count_of = [&](const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = client[0].heard().find(word, at)) != std::string::npos; ++at) ++count;
    return count;
  };
  const std::string result = "{\"id\":";
  ASSERT_TRUE(listen_until(client, 60s, [&] { return count_of(result) == 3; })) << client[0].heard();
  EXPECT_FALSE(client[0].heard().ends_with("\r\n0\r\n\r\n"));
  EXPECT_GT(lines_heard(), 3);
  client_->Delete("/v1/solves/" + std::string(batch.at("solves")[0]));
  ASSERT_TRUE(listen_until(client, 60s, [&] { return client[0].heard().ends_with("\r\n0\r\n\r\n"); }));
  const Reply reply = read_replies(client[0].heard()).at(0);
  const std::vector<json> lines = lines_of(reply.body);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[3].at("id"), batch.at("solves")[0]);
  EXPECT_EQ(lines[3].at("status"), "cancelled");
  // The connection takes the next request.
  client[0].send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(listen_until(client, 60s, [&] { return read_replies(client[0].heard()).size() == 2; }));
}

TEST_P(Batches, StandInOneLineEachHoweverTheirProblemsAreWritten) {
  const json pretty = json::parse(problem_titled("a\nb \" \\ <b>"));
  std::string body = "{\"problems\": [" + pretty.dump(4) + "\r\n]}";
  const json batch = json::parse(client_->Post("/v1/batches", body, "application/json")->body);
  const std::vector<json> lines = lines_of(results_of(batch, "?fields=problem"));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].at("problem"), pretty);
}

TEST_P(Batches, ComeAsACborSequence) {
  const json batch = accepted(batch_of({"instant", "touches"}));
  const auto reply = get(std::string(batch.at("links").at("results")) + "?fields=summary",
                         {{"Accept", "application/cbor-seq"}});
  ASSERT_EQ(reply->status, 200);
  EXPECT_EQ(reply->get_header_value("Content-Type"), "application/cbor-seq");
  std::istringstream bytes(reply->body);
  std::set<std::string> ids;
  while (bytes.peek() != std::istringstream::traits_type::eof())
    ids.insert(json::from_cbor(bytes, false).at("id").get<std::string>());
  EXPECT_EQ(ids.size(), 2u);
  EXPECT_EQ(get(batch.at("links").at("results"), {{"Accept", "application/json"}})->status, 406);
  EXPECT_EQ(get(std::string(batch.at("links").at("results")) + "?fields=none")->status, 400);
  EXPECT_EQ(client_->Head(std::string(batch.at("links").at("results")))->status, 200);
  std::vector<RawClient> old;
  old.emplace_back(service_->port());
  old[0].send("GET " + std::string(batch.at("links").at("results")) + " HTTP/1.0\r\n\r\n");
  EXPECT_TRUE(listen_until(old, 60s, [&] { return old[0].closed(); }));
  EXPECT_EQ(old[0].heard().find("chunked"), std::string::npos);
  EXPECT_EQ(lines_of(old[0].heard().substr(old[0].heard().find("\r\n\r\n") + 4)).size(), 2u);
  const auto in_cbor = json::to_cbor(batch_of({"instant"}));
  EXPECT_EQ(client_->Post("/v1/batches", {}, std::string(in_cbor.begin(), in_cbor.end()), "application/cbor")
                ->status,
            202);
}

TEST_P(Batches, AreRefusedAsAWhole) {
  json batch = batch_of({"instant", "instant", "instant"});
  batch["problems"][1]["load"] = 7;
  batch["problems"][2]["tags"] = {""};
  const json refusal = expect_problem(post(batch), 422);
  ASSERT_EQ(refusal.at("errors").size(), 2u) << refusal;
  EXPECT_EQ(refusal.at("errors")[0].at("pointer"), "/problems/1/load");
  EXPECT_EQ(refusal.at("errors")[1].at("pointer"), "/problems/2/tags/0");
  json large = batch_of({"instant", "instant"});
  large["problems"][1]["mesh"]["divisions"] = {100, 100};
  const json too_large = expect_problem(post(large), 413);
  EXPECT_EQ(too_large.at("errors")[0].at("pointer"), "/problems/1/mesh");
  expect_problem(client_->Post("/v1/batches", "{\"problems\": [{}", "application/json"), 400);
  expect_problem(client_->Post("/v1/batches", "[]", "text/plain"), 415);
  expect_problem(client_->Post("/v1/batches?wait=3", batch_of({"instant"}).dump(), "application/json"), 400);
  expect_problem(client_->Post("/v1/batches", problem_titled("instant"), "application/json"), 422);
  json many{{"problems", json::array()}};
  for (int i = 0; i < 1000; ++i) many["problems"].push_back(json::object());
  EXPECT_EQ(expect_problem(post(many), 422).at("errors").size(), 101u);
  EXPECT_EQ(expect_problem(get("/v1/batches"), 405).at("status"), 405);
  EXPECT_EQ(solves(), 0u);
}

TEST_P(Batches, FitIntoTheQueueOrDoNot) {
  // Two of the first run; what waits of it, and each that follows, is one request.
  const json first = accepted(batch_of({"slow", "slow", "slow", "slow"}));
  wait_for_running(2);
  for (int i = 1; i < kQueueLimit; ++i) accepted(batch_of({"slow", "slow", "slow"}));
  const auto full = post(batch_of({"instant", "instant"}));
  const json refusal = expect_problem(full, 503);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--queue-limit"), std::string::npos) << refusal;
  EXPECT_FALSE(full->get_header_value("Retry-After").empty());
  EXPECT_EQ(solves(), 4u + 3 * (kQueueLimit - 1));
  client_->Delete("/v1/solves/" + std::string(first.at("solves")[3]));
  expect_problem(post(batch_of({"instant"})), 503);
  client_->Delete("/v1/solves/" + std::string(first.at("solves")[2]));
  accepted(batch_of({"instant"}));
  expect_problem(post(batch_of({"instant"})), 503);
}

TEST_P(Batches, AreTheSameByTheirKey) {
  const json sent = batch_of({"instant", "short"});
  const httplib::Headers key{{"Idempotency-Key", "k"}}, other{{"Idempotency-Key", "o"}};
  const json first = accepted(sent, key);
  EXPECT_EQ(accepted(sent, key), first);
  EXPECT_EQ(solves(), 2u);
  EXPECT_NE(accepted(sent, other), first);
  const json reused = expect_problem(post(batch_of({"instant"}), key), 422);
  EXPECT_NE(reused.at("detail").get<std::string>().find(std::string(first.at("links").at("self"))),
            std::string::npos)
      << reused;
  // A key is that of one solve or of one batch.
  expect_problem(client_->Post("/v1/solves", key, problem_titled("instant"), "application/json"), 422);
  client_->Post("/v1/solves", {{"Idempotency-Key", "s"}}, problem_titled("instant"), "application/json");
  expect_problem(post(sent, {{"Idempotency-Key", "s"}}), 422);
  if (GetParam()) {
    start();
    EXPECT_EQ(accepted(sent, key), first);
  }
  // Gone with its solves, as its key is.
  results_of(first);
  EXPECT_EQ(json::parse(client_->Delete(std::string(first.at("links").at("self")))->body),
            (json{{"cancelled", 0}, {"deleted", 2}}));
  expect_problem(get(first.at("links").at("self")), 404);
  EXPECT_NE(accepted(sent, key), first);
}

TEST_P(Batches, GoOnWithoutTheSolvesThatAreDeleted) {
  const json batch = accepted(batch_of({"instant", "instant", "slow"}));
  const std::string first = batch.at("solves")[0], last = batch.at("solves")[2];
  ASSERT_TRUE(becomes([&] { return status_of(batch).at("counts").at("succeeded") == 2; }));
  EXPECT_EQ(client_->Delete("/v1/solves/" + first)->status, 204);
  EXPECT_EQ(status_of(batch).at("counts").at("deleted"), 1);
  EXPECT_EQ(status_of(batch).at("solves"), batch.at("solves"));
  std::vector<RawClient> client;
  client.push_back(listener_to(batch));
  ASSERT_TRUE(
      listen_until(client, 60s, [&] { return client[0].heard().find("succeeded") != std::string::npos; }));
  // All of them while somebody listens.
  expect_problem(client_->Delete(std::string(batch.at("links").at("self")), {{"If-Match", "\"x\""}}), 412);
  const auto gone = client_->Delete(std::string(batch.at("links").at("self")));
  EXPECT_EQ(json::parse(gone->body), (json{{"cancelled", 1}, {"deleted", 1}}));
  ASSERT_TRUE(listen_until(client, 60s, [&] { return client[0].heard().ends_with("\r\n0\r\n\r\n"); }));
  EXPECT_EQ(lines_of(read_replies(client[0].heard()).at(0).body).size(), 2u);
  client_->Delete("/v1/solves/" + last);
  expect_problem(get(batch.at("links").at("self")), 404);
}

TEST_P(Batches, HaveAsManyListenersAsMayBe) {
  const json batch = accepted(batch_of({"slow"}));
  {
    std::vector<RawClient> clients;
    for (int i = 0; i < 3; ++i) clients.push_back(listener_to(batch));
    ASSERT_TRUE(listen_until(clients, 60s, [&] {
      return std::ranges::all_of(clients, [](const RawClient& client) { return client.status() == 200; });
    }));
    expect_problem(get(batch.at("links").at("results")), 503);
  }
  // They have left.
  std::vector<RawClient> next;
  const bool heard = [&] {
    for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(20ms)) {
      next.clear();
      next.push_back(listener_to(batch));
      listen_until(next, 2s, [&] { return next[0].status() != 0; });
      if (next[0].status() == 200) return true;
    }
    return false;
  }();
  EXPECT_TRUE(heard);
  // A service that stops breaks the reply off, so that nobody takes it for whole; but for one that keeps
  // nothing, where all solves end with it.
  service_->stop();
  EXPECT_TRUE(listen_until(next, 60s, [&] { return next[0].closed(); }));
  EXPECT_EQ(next[0].heard().ends_with("0\r\n\r\n"), !GetParam()) << next[0].heard();
}

TEST_P(Batches, HoldNoThreadWhileTheyWait) {
  const json batch = accepted(batch_of({"slow"}));
  std::vector<RawClient> clients;
  clients.push_back(listener_to(batch));
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return clients[0].status() == 200; }));
  const double before = figures_of(::getpid()).threads;
  for (int i = 0; i < 2; ++i) clients.push_back(listener_to(batch));
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return clients.back().status() == 200; }));
  EXPECT_EQ(figures_of(::getpid()).threads, before);
  EXPECT_EQ(get("/healthz")->status, 200);
}

/// Results of megabytes, for one who takes none of them.
TEST_P(Batches, DoNotWaitForWhoStalls) {
  const json batch = accepted(batch_of({"large", "large", "large", "large"}));
  std::vector<RawClient> deaf;
  for (int i = 0; i < 2; ++i) {
    deaf.emplace_back(service_->port());
    deaf[i].turn_deaf();
    deaf[i].send("GET " + std::string(batch.at("links").at("results")) +
                 " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(lines_of(results_of(batch, "")).size(), 4u);
  EXPECT_EQ(get("/healthz")->status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
  // Of those who have left nothing is kept.
  deaf.clear();
  EXPECT_TRUE(becomes(
      [&] { return get(std::string(batch.at("links").at("results")) + "?fields=summary")->status != 503; }));
  EXPECT_EQ(lines_of(results_of(batch)).size(), 4u);
}

INSTANTIATE_TEST_SUITE_P(Stores, Batches, testing::Bool());

/// All that was promised, after a death at any time.
TEST(KilledBatch, IsSolvedOnce) {
  const TemporaryDirectory directory;
  const std::vector<std::string> flags{"--data-dir", directory.path() + "/data", "--workers", "1"};
  json batch;
  for (int i = 0; i < 40; ++i) batch["problems"].push_back(paper_problem(16));
  const httplib::Headers key{{"Idempotency-Key", "once"}};
  json accepted;
  std::set<std::string> told;
  {
    Daemon daemon(flags);
    httplib::Client client("127.0.0.1", daemon.port());
    client.set_read_timeout(100);
    accepted = json::parse(client.Post("/v1/batches", key, batch.dump(), "application/json")->body);
    std::vector<RawClient> reader;
    reader.emplace_back(daemon.port());
    reader[0].send("GET " + std::string(accepted.at("links").at("results")) +
                   "?fields=summary HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_TRUE(
        listen_until(reader, 60s, [&] { return reader[0].heard().find("succeeded") != std::string::npos; }));
    daemon.process().signal(SIGKILL);
    daemon.process().wait(10s);
  }
  Daemon daemon(flags);
  httplib::Client client("127.0.0.1", daemon.port());
  client.set_read_timeout(60);
  EXPECT_EQ(json::parse(client.Post("/v1/batches", key, batch.dump(), "application/json")->body), accepted);
  const auto results = client.Get(std::string(accepted.at("links").at("results")) + "?fields=summary");
  for (const json& line : lines_of(results->body)) {
    EXPECT_EQ(line.at("status"), "succeeded");
    EXPECT_TRUE(told.insert(line.at("id")).second);
  }
  EXPECT_EQ(told.size(), 40u);
  EXPECT_EQ(json::parse(client.Get("/v1/solves?limit=1000")->body).at("solves").size(), 40u);
}

}  // namespace
}  // namespace signorini::server::batches_test
