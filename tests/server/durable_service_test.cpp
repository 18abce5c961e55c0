// The service on disk, through HTTP.

#include "becomes.hpp"
#include "running_service.hpp"

#include <fstream>
#include <thread>

#include "child_process.hpp"
#include "example_problems.hpp"
#include "faulty_disk.hpp"
#include "server/jobs/sqlite/store.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::durable_service_test {
namespace {

using nlohmann::json;

class DurableService : public testing::Test {
 protected:
  ~DurableService() override { FaultyDisk::fail(FaultyDisk::Fault::none); }

  httplib::Client start() {
    service_.reset();
    ServiceOptions options;
    options.data_dir = directory_.path();
    options.vfs = FaultyDisk::vfs();
    service_ = std::make_unique<RunningService>(options);
    httplib::Client client("127.0.0.1", service_->port());
    client.set_read_timeout(100);
    return client;
  }

  static httplib::Result post(httplib::Client& client, const std::string& title,
                              const std::string& query = {}, const httplib::Headers& headers = {}) {
    return client.Post("/v1/solves" + query, headers, problem_titled(title), "application/json");
  }

  /// In each format that there is.
  static std::string read(httplib::Client& client, const std::string& path) {
    return client.Get(path)->body + client.Get(path, {{"Accept", "application/cbor"}})->body;
  }

  static json wait_for(httplib::Client& client, const std::string& id, const std::string& status) {
    json document;
    EXPECT_TRUE(becomes([&] {
      document = json::parse(client.Get("/v1/solves/" + id)->body);
      return document.at("status") == status;
    })) << "not "
        << status << ": " << document;
    return document;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<RunningService> service_;
};

TEST_F(DurableService, ServesTheSameBytesAfterARestart) {
  std::map<std::string, std::string> bodies;
  {
    httplib::Client client = start();
    for (const char* title : {"elastic", "touches", "diverges", "no solution"}) {
      const std::string id = json::parse(post(client, title, "?wait=60")->body).at("id");
      for (const char* suffix : {"", "/result", "/result?fields=stress", "/result.vtu", "/contact.csv",
                                 "/history", "/history.csv"}) {
        bodies["/v1/solves/" + id + suffix] = "";
      }
    }
    bodies["/v1/solves"] = "";
    for (auto& [path, body] : bodies) body = read(client, path);
  }
  httplib::Client client = start();
  for (const auto& [path, body] : bodies) {
    // A refusal names no request, so even that is the same.
    EXPECT_EQ(read(client, path), body) << path;
  }
}

TEST_F(DurableService, GoesOnAfterAStopWithWhatHadNotEnded) {
  std::vector<std::string> ids;
  {
    httplib::Client client = start();
    for (const char* title : {"slow", "slow", "instant"}) {
      ids.push_back(json::parse(post(client, title)->body).at("id"));
    }
    wait_for(client, ids[1], "running");
    std::thread waiting([&] {
      httplib::Client other("127.0.0.1", service_->port());
      other.set_read_timeout(100);
      const auto reply = post(other, "instant", "?wait=15");
      ASSERT_TRUE(reply);
      EXPECT_EQ(reply->status, 202);
      EXPECT_EQ(json::parse(reply->body).at("status"), "queued");
      ids.push_back(json::parse(reply->body).at("id"));
    });
    EXPECT_TRUE(
        becomes([&] { return json::parse(client.Get("/v1/solves")->body).at("solves").size() >= 4; }));
    service_->stop();
    waiting.join();
  }
  httplib::Client client = start();
  for (int i : {0, 1}) {
    wait_for(client, ids.at(i), "running");
    client.Delete("/v1/solves/" + ids[i]);
    wait_for(client, ids[i], "cancelled");
  }
  for (int i : {2, 3}) wait_for(client, ids.at(i), "succeeded");
}

TEST_F(DurableService, AnswersARepeatedRequestWithTheSameSolve) {
  const httplib::Headers key{{"Idempotency-Key", "8e03978e-40d5-43dd-bc93-6894a57f9324"}};
  std::string id;
  {
    httplib::Client client = start();
    const auto first = post(client, "instant", "?wait=60", key);
    EXPECT_EQ(first->status, 200);
    id = json::parse(first->body).at("id");
  }
  httplib::Client client = start();
  const auto again = post(client, "instant", "", key);
  EXPECT_EQ(again->status, 202);
  EXPECT_EQ(again->get_header_value("Location"), "/v1/solves/" + id);
  EXPECT_EQ(json::parse(again->body).at("status"), "succeeded");
  EXPECT_EQ(json::parse(post(client, "instant", "?wait=60", key)->body).at("id"), id);

  const json refusal = expect_problem(post(client, "short", "", key), 422);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("8e03978e"), std::string::npos);
  EXPECT_NE(refusal.at("detail").get<std::string>().find(id), std::string::npos);
  expect_problem(post(client, "instant", "", {{"Idempotency-Key", std::string(256, 'k')}}), 400);
  expect_problem(post(client, "instant", "", {{"Idempotency-Key", "two words"}}), 400);
  EXPECT_EQ(json::parse(client.Get("/v1/solves")->body).at("solves").size(), 1u);
}

TEST_F(DurableService, RefusesCleanlyWhileTheDiskIsFullAndRecovers) {
  httplib::Client client = start();
  const std::string running = json::parse(post(client, "short")->body).at("id");
  wait_for(client, running, "running");

  FaultyDisk::fail(FaultyDisk::Fault::full);
  for (const auto& reply : {post(client, "instant"), client.Delete("/v1/solves/" + running)}) {
    const json refusal = expect_problem(reply, 503);
    EXPECT_NE(refusal.at("detail").get<std::string>().find("full"), std::string::npos);
    EXPECT_FALSE(reply->get_header_value("Retry-After").empty());
  }
  expect_problem(client.Get("/readyz"), 503);
  EXPECT_EQ(client.Get("/healthz")->status, 200);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  // It has ended by now, but that cannot be kept.
  EXPECT_EQ(json::parse(client.Get("/v1/solves/" + running)->body).at("status"), "running");

  FaultyDisk::fail(FaultyDisk::Fault::none);
  EXPECT_EQ(client.Get("/readyz")->status, 200);
  wait_for(client, running, "succeeded");
  EXPECT_EQ(post(client, "instant", "?wait=60")->status, 200);
}

/// What a service that was killed in its first moments can leave.
TEST(EmptyFile, IsAnEmptyStore) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() + "/jobs.sqlite";
  std::ofstream(file, std::ios::binary).flush();
  ChildProcess check({"check", directory.path()});
  EXPECT_EQ(check.wait(std::chrono::seconds(60)), 0) << check.standard_error();
  EXPECT_NE(check.standard_output().find("is empty"), std::string::npos) << check.standard_output();

  std::filesystem::remove(file);
  std::ofstream(file, std::ios::binary).flush();
  Daemon daemon({"--data-dir", directory.path()});
  httplib::Client client("127.0.0.1", daemon.port());
  EXPECT_EQ(client.Get("/readyz")->status, 200);
  EXPECT_TRUE(json::parse(client.Get("/v1/solves")->body).at("solves").empty());
  EXPECT_EQ(client.Post("/v1/solves?wait=20", problem_titled("first"), "application/json")->status, 200);
  EXPECT_EQ(daemon.process().standard_error().find("damaged"), std::string::npos)
      << daemon.process().standard_error();
}

/// A daemon of which no file may be longer than so many KiB.
class LimitedFiles : public testing::Test {
 protected:
  void start(int kib) {
    daemon_ = std::make_unique<Daemon>(
        std::vector<std::string>{"--data-dir", directory_.path()},
        std::vector<std::string>{"bash", "-c",
                                 "ulimit -f " + std::to_string(kib) + " && exec \"$0\" \"$@\""});
    client_ = std::make_unique<httplib::Client>("127.0.0.1", daemon_->port());
    client_->set_read_timeout(60);
  }

  httplib::Result post() {
    return client_->Post("/v1/solves?wait=20&fields=summary", paper_problem(96).dump(), "application/json");
  }

  int readiness() { return client_->Get("/readyz")->status; }

  /// Solves are taken until they are refused; their number.
  int fill() {
    constexpr int more_than_fit = 100;
    for (int number = 0; number < more_than_fit; ++number) {
      if (post()->status != 200) return number;
    }
    return more_than_fit;
  }

  void delete_all() {
    const json page = json::parse(client_->Get("/v1/solves?limit=1000")->body);
    for (const json& solve : page.at("solves")) {
      const auto reply = client_->Delete("/v1/solves/" + std::string(solve.at("id")));
      EXPECT_EQ(reply->status, 204) << reply->body;
    }
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Daemon> daemon_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(LimitedFiles, AreAsAFullDisk) {
  start(16 * 1024);
  EXPECT_EQ(readiness(), 200);
  const int taken = fill();
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 100);
  for (const auto& reply : {post(), client_->Get("/readyz")}) {
    const json refusal = expect_problem(reply, 503);
    EXPECT_NE(refusal.at("detail").get<std::string>().find("ulimit -f"), std::string::npos) << refusal;
  }
  EXPECT_EQ(client_->Get("/healthz")->status, 200);
  delete_all();
  EXPECT_TRUE(becomes([&] { return readiness() == 200; }));
  EXPECT_EQ(post()->status, 200);
}

TEST_F(LimitedFiles, ThatHoldNothingAreToldOfAtOnce) {
  start(1024);
  const json refusal = expect_problem(client_->Get("/readyz"), 503);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("ulimit -f"), std::string::npos) << refusal;
  expect_problem(post(), 503);
  EXPECT_EQ(client_->Get("/healthz")->status, 200);
}

}  // namespace
}  // namespace signorini::server::durable_service_test
