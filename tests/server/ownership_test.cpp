// Tokens with names: what is whose, and who may do what.

#include "becomes.hpp"
#include "running_service.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include "api/examples.hpp"
#include "child_process.hpp"
#include "server/access/bearer_tokens.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::ownership_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::string anne = "anne-has-this-token", bert = "bert-has-this-token", chief = "chief-has-this-token",
                  viewer = "viewer-has-this-token", slow = "slow-has-this-token-1",
                  bare = "nobody-has-this-token";

std::string write_tokens(const std::string& file) {
  std::ofstream(file) << "anne read,solve " << anne << " queue=1 memory=1gb\n"
                      << "bert read,solve " << bert << "\n\n"
                      << "chief admin " << chief << "\r\n"
                      << "viewer read " << viewer << "\n"
                      << "slow read,solve " << slow << " rate=2 memory=1mb\n"
                      << bare << "\n";
  return file;
}

class Owners : public testing::TestWithParam<bool> {
 protected:
  Owners() {
    ServiceOptions options;
    options.workers = 1;
    options.queue_limit = 10;
    options.token_file = write_tokens(directory_.path() + "/tokens");
    if (GetParam()) options.data_dir = directory_.path() + "/data";
    service_ = std::make_unique<RunningService>(options);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", service_->port());
    client_->set_read_timeout(100);
  }

  static httplib::Headers as(const std::string& token, const std::string& key = {}) {
    httplib::Headers headers{{"Authorization", "Bearer " + token}};
    if (!key.empty()) headers.emplace("Idempotency-Key", key);
    return headers;
  }
  httplib::Result get(const std::string& token, const std::string& path) {
    return client_->Get(path, as(token));
  }
  httplib::Result remove(const std::string& token, const std::string& path) {
    return client_->Delete(path, as(token));
  }
  httplib::Result post(const std::string& token, const std::string& title, const std::string& query = {},
                       const std::string& key = {}) {
    return client_->Post("/v1/solves" + query, as(token, key), problem_titled(title), "application/json");
  }
  std::size_t solves(const std::string& token) {
    return json::parse(get(token, "/v1/solves")->body).at("solves").size();
  }

  TemporaryDirectory directory_;
  std::unique_ptr<RunningService> service_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_P(Owners, SeeAndDeleteTheirOwnOnly) {
  const std::string id = json::parse(post(anne, "touches", "?wait=10")->body).at("id");
  const std::string path = "/v1/solves/" + id;
  for (const char* suffix : {"", "/result", "/result.vtu", "/history", "/history.csv", "/contact.csv",
                             "/quantities.csv", "/events"}) {
    EXPECT_EQ(get(anne, path + suffix)->status, 200) << suffix;
    EXPECT_EQ(get(chief, path + suffix)->status, 200) << suffix;
    for (const std::string& other : {bert, viewer, bare}) expect_problem(get(other, path + suffix), 404);
  }
  EXPECT_EQ(solves(anne), 1u);
  EXPECT_EQ(solves(chief), 1u);
  EXPECT_EQ(solves(bert), 0u);
  expect_problem(remove(bert, path), 404);
  EXPECT_EQ(get(anne, path)->status, 200);
  EXPECT_EQ(remove(anne, path)->status, 204);
  const std::string other = json::parse(post(bert, "instant", "?wait=10")->body).at("id");
  EXPECT_EQ(remove(chief, "/v1/solves/" + other)->status, 204);
}

TEST_P(Owners, HaveIdempotencyKeysOfTheirOwn) {
  const std::string first = json::parse(post(anne, "instant", "?wait=10", "key")->body).at("id");
  const auto other = post(bert, "touches", "?wait=10", "key");
  EXPECT_EQ(other->status, 200) << other->body;
  EXPECT_NE(json::parse(other->body).at("id"), first);
  EXPECT_EQ(json::parse(post(anne, "instant", "?wait=10", "key")->body).at("id"), first);
  expect_problem(post(anne, "touches", "", "key"), 422);
}

TEST_P(Owners, FindAndDeleteTheirOwnByTag) {
  json problem = json::parse(problem_titled("instant"));
  problem["tags"] = {"t"};
  const auto post_tagged = [&](const std::string& token) {
    client_->Post("/v1/solves?wait=10", as(token), problem.dump(), "application/json");
  };
  for (const std::string& token : {anne, anne, bert}) post_tagged(token);
  const auto tagged = [&](const std::string& token, const std::string& filter) {
    return json::parse(get(token, "/v1/solves" + filter)->body).at("solves").size();
  };
  for (const char* filter : {"?tag=t", "?title=insta", "?tag=t&title=t&status=succeeded"}) {
    EXPECT_EQ(tagged(anne, filter), 2u) << filter;
    EXPECT_EQ(tagged(bert, filter), 1u) << filter;
    EXPECT_EQ(tagged(chief, filter), 3u) << filter;
    EXPECT_EQ(tagged(viewer, filter), 0u) << filter;
  }
  expect_problem(remove(viewer, "/v1/solves?tag=t&confirm=0"), 403);
  EXPECT_EQ(expect_problem(remove(bare, "/v1/solves?tag=t"), 409).at("count"), 0);
  EXPECT_EQ(expect_problem(remove(bert, "/v1/solves?tag=t"), 409).at("count"), 1);
  EXPECT_EQ(remove(bert, "/v1/solves?tag=t&confirm=1")->status, 200);
  EXPECT_EQ(tagged(anne, "?tag=t"), 2u);
  EXPECT_EQ(expect_problem(remove(chief, "/v1/solves?tag=t"), 409).at("count"), 2);
  EXPECT_EQ(json::parse(remove(chief, "/v1/solves?tag=t&confirm=2")->body).at("deleted"), 2);
}

TEST_P(Owners, DoWhatTheirScopesSay) {
  EXPECT_EQ(get(viewer, "/v1/solves")->status, 200);
  const auto refused = post(viewer, "instant");
  const json refusal = expect_problem(refused, 403);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("`solve`"), std::string::npos) << refusal;
  EXPECT_NE(refused->get_header_value("WWW-Authenticate").find("insufficient_scope"), std::string::npos);
  expect_problem(remove(viewer, "/v1/solves/0"), 403);
  EXPECT_EQ(post(chief, "instant", "?wait=10")->status, 200);
  EXPECT_EQ(post(bare, "instant", "?wait=10")->status, 200);
}

/// A service of which one token is for a monitor.
class Monitors : public ServiceTest {
 protected:
  Monitors() : ServiceTest(options()) {}

  static ServiceOptions options() {
    static const TemporaryDirectory directory;
    ServiceOptions options;
    options.token_file = directory.path() + "/tokens";
    std::ofstream(options.token_file) << "grafana metrics " << monitor << "\n"
                                      << "viewer read " << viewer << "\n"
                                      << "sender solve " << sender << "\n";
    return options;
  }

  int status_of_get(const std::string& token, const std::string& path) {
    return client_.Get(path, {{"Authorization", "Bearer " + token}})->status;
  }

  static inline const std::string monitor = "grafana-has-this-token", sender = "sender-has-this-token";
};

TEST_F(Monitors, ReadTheMetricsAndNothingElse) {
  const httplib::Headers as_monitor{{"Authorization", "Bearer " + monitor}};
  EXPECT_EQ(status_of_get(monitor, "/metrics"), 200);
  EXPECT_EQ(client_.Head("/metrics", as_monitor)->status, 200);
  EXPECT_EQ(client_.Options("/metrics", as_monitor)->status, 204);
  for (const Route& route : service_.router().table()) {
    if (route.method != "GET" || route.pattern == "/metrics") continue;
    std::string path = route.pattern;
    std::erase_if(path, [](char c) { return c == '{' || c == '}'; });
    const int status = status_of_get(monitor, path);
    EXPECT_EQ(status == 403, route.audience == Audience::clients) << route.pattern << ' ' << status;
  }
  for (const char* path : {"/nothing", "/metrics/x"}) EXPECT_EQ(status_of_get(monitor, path), 403) << path;
  for (const char* path : {"/v1/solves", "/v1/studies", "/v1/validate", "/metrics"})
    expect_problem(client_.Post(path, as_monitor, problem_titled("instant"), "application/json"), 403);
  for (const char* path : {"/v1/solves/0", "/metrics"}) expect_problem(client_.Delete(path, as_monitor), 403);
}

TEST_F(Monitors, AreNotAloneWithThem) {
  EXPECT_EQ(status_of_get(viewer, "/metrics"), 200);
  expect_problem(get("/metrics"), 401);
  const auto refused = client_.Get("/metrics", {{"Authorization", "Bearer " + sender}});
  const json refusal = expect_problem(refused, 403);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("`metrics`"), std::string::npos) << refusal;
}

TEST_F(Monitors, SeeHowMuchAllNamesSolveAndNotWho) {
  const auto solved = client_.Post("/v1/solves?wait=60", {{"Authorization", "Bearer " + sender}},
                                   problem_titled("instant"), "application/json");
  ASSERT_EQ(solved->status, 200) << solved->body;
  const std::string id = json::parse(solved->body).at("id");
  for (const std::string& token : {monitor, viewer}) {
    const std::string text = client_.Get("/metrics", {{"Authorization", "Bearer " + token}})->body;
    EXPECT_NE(text.find(R"(signorini_solves{status="succeeded"} 1)"), std::string::npos) << text;
    for (const std::string& secret : {std::string("sender"), std::string("instant"), id})
      EXPECT_EQ(text.find(secret), std::string::npos) << secret;
  }
}

TEST_P(Owners, HaveTheirShareOfTheQueue) {
  ASSERT_EQ(post(bert, "slow")->status, 202);
  ASSERT_TRUE(becomes(
      [&] { return !json::parse(get(bert, "/v1/solves?status=running")->body).at("solves").empty(); }));
  EXPECT_EQ(post(anne, "instant")->status, 202);
  const auto more = post(anne, "instant");
  const json refusal = expect_problem(more, 429);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("`anne`"), std::string::npos) << refusal;
  EXPECT_FALSE(more->get_header_value("Retry-After").empty());
  EXPECT_EQ(post(bert, "instant")->status, 202);
}

TEST_P(Owners, AskAsOftenAsTheirNameMay) {
  std::map<int, int> count;
  for (int i = 0; i < 6; ++i) ++count[get(slow, "/v1/solves")->status];
  EXPECT_GE(count[200], 2);
  EXPECT_GE(count[429], 1);
  EXPECT_EQ(get(bert, "/v1/solves")->status, 200);
}

/// Nobody waits for what can never be.
TEST_P(Owners, ArePromisedNoMemoryThatTheyDoNotHave) {
  json problem = json::parse(problem_titled("instant"));
  problem["mesh"] = {{"divisions", {16, 16}}};
  for (const char* path : {"/v1/solves", "/v1/validate"}) {
    const json refusal =
        expect_problem(client_->Post(path, as(slow), problem.dump(), "application/json"), 413);
    EXPECT_EQ(refusal.at("type"), "urn:signorini:problem:too-much-memory");
    EXPECT_NE(refusal.value("detail", "").find("0.00105 GB to the solves of `slow`"), std::string::npos)
        << refusal;
  }
}

INSTANTIATE_TEST_SUITE_P(Stores, Owners, testing::Bool());

TEST(BearerTokens, GiveABareTokenTheSameNameWhereverItStands) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() + "/tokens";
  std::ofstream(file) << bare << "\n";
  const std::string name = BearerTokens(file).identify("Bearer " + bare)->name;
  EXPECT_NE(name, "");
  EXPECT_EQ(BearerTokens(write_tokens(file)).identify("Bearer " + bare)->name, name);
  EXPECT_EQ(bare.find(name), std::string::npos);
}

/// In a process: its log, and the signal.
TEST(TokenFile, IsReadAgainOnHangupAndItsTokensStayOutOfTheLog) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() + "/tokens";
  std::ofstream(file) << "anne read,solve " << anne << "\n";
  Daemon daemon({"--token-file", file});
  httplib::Client client("127.0.0.1", daemon.port());
  const auto status = [&](const std::string& token) {
    return client.Get("/v1/solves?access_token=" + token, {{"Authorization", "Bearer " + token}})->status;
  };
  const auto wait_for_status = [&](const std::string& token, int wanted) {
    EXPECT_TRUE(becomes([&] { return status(token) == wanted; }))
        << token << daemon.process().standard_error();
  };
  json problem = json::parse(problem_titled("small"));
  const auto sent = client.Post("/v1/solves?wait=60", {{"Authorization", "Bearer " + anne}}, problem.dump(),
                                "application/json");
  ASSERT_EQ(sent->status, 200);
  const std::string id = json::parse(sent->body).at("id");
  client.Delete("/v1/solves/" + id, {{"Authorization", "Bearer " + anne}});
  const std::string log = daemon.process().standard_error();
  for (const char* change : {" accepted", " deleted"}) {
    const std::size_t at = log.find(change);
    ASSERT_NE(at, std::string::npos) << log;
    const std::string line = log.substr(log.rfind('\n', at) + 1, at - log.rfind('\n', at));
    for (const std::string& part :
         {std::string("client=anne"), std::string("address=127.0.0.1"), "job=" + id})
      EXPECT_NE(line.find(part), std::string::npos) << line;
  }

  EXPECT_EQ(status(bert), 401);
  std::ofstream(file) << "bert read " << bert << "\n";
  daemon.process().signal(SIGHUP);
  wait_for_status(bert, 400);  // the service knows no such parameter
  EXPECT_EQ(status(anne), 401);
  std::ofstream(file) << "nonsense\n";
  daemon.process().signal(SIGHUP);
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(status(bert), 400);
  EXPECT_NE(daemon.process().standard_error().find("stay as they were"), std::string::npos);
  for (const std::string& token : {anne, bert})
    EXPECT_EQ(daemon.process().standard_error().find(token), std::string::npos)
        << daemon.process().standard_error();
}

/// Where none belongs, in any spelling, and also if it is no token of this service.
TEST(TokenFile, HidesTokensInTheLogWhereverClientsPutThem) {
  const TemporaryDirectory directory;
  const std::string file = directory.path() + "/tokens", other = "somebody-elses-token";
  std::ofstream(file) << "anne read,solve " << anne << "\n";
  Daemon daemon({"--token-file", file});
  httplib::Client client("127.0.0.1", daemon.port());
  client.set_url_encode(false);
  std::string coded = anne;
  coded.replace(3, 1,
                "%" + std::string(1, "0123456789ABCDEF"[anne[3] / 16]) + "0123456789ABCDEF"[anne[3] % 16]);
  for (const std::string& query :
       {"access_token=" + other, "access%5Ftoken=" + other, "%61ccess_token=" + other,
        "Access_Token=" + other, "ACCESS_TOKEN=" + other + "/" + other, "x;access_token=" + other,
        "limit=1&access_token=" + other, "limit=" + anne, "access%5ftoken=" + anne, "limit=" + coded})
    EXPECT_EQ(client.Get("/v1/solves?" + query)->status, 401);
  EXPECT_EQ(client.Get("/v1/solves/" + anne)->status, 401);
  const auto reply = client.Get("/healthz", {{"X-Request-Id", anne}});
  EXPECT_EQ(reply->get_header_value("X-Request-Id"), anne);
  const std::string raw = "GET /v1/solves?Access_Token=" + other + "< HTTP/1.1\r\nHost: localhost\r\n\r\n";
  EXPECT_NE(send_raw(daemon.port(), raw).find(" 400 "), std::string::npos);
  const std::string log = daemon.process().standard_error();
  for (const std::string& secret : {anne, coded, other})
    EXPECT_EQ(log.find(secret), std::string::npos) << log;
  EXPECT_NE(log.find("path=/v1/solves?limit=1&access_token=*** "), std::string::npos) << log;
  EXPECT_NE(log.find("request=*** "), std::string::npos) << log;
}

TEST(Hangup, EndsNoService) {
  Daemon daemon;
  daemon.process().signal(SIGHUP);
  std::this_thread::sleep_for(300ms);
  httplib::Client client("127.0.0.1", daemon.port());
  const auto reply = client.Get("/healthz");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
}

}  // namespace
}  // namespace signorini::server::ownership_test
