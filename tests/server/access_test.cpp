#include "server/access/access.hpp"

#include <csignal>
#include <fstream>
#include <set>

#include "becomes.hpp"
#include "child_process.hpp"
#include "raw_client.hpp"
#include "running_service.hpp"
#include "server/jobs/memory_budget.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::access_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::string first_token = "0123456789abcdef";
const std::string second_token = "another-token-that-is-longer";

std::string token_file(const std::string& text = first_token + "\n\n" + second_token + "\r\n") {
  static const TemporaryDirectory directory;
  static int files = 0;
  const std::string file = directory.path() + "/" + std::to_string(++files);
  std::ofstream(file) << text;
  return file;
}

class Tokens : public ServiceTest {
 protected:
  Tokens() : ServiceTest(options()) {}

  static ServiceOptions options() {
    ServiceOptions options;
    options.token_file = token_file();
    return options;
  }

  httplib::Result get_with(const std::string& authorization) {
    return client_.Get("/v1/solves", {{"Authorization", authorization}});
  }
};

TEST_F(Tokens, LetTheirHoldersIn) {
  for (const std::string& token : {first_token, second_token}) {
    EXPECT_EQ(get_with("Bearer " + token)->status, 200);
    EXPECT_EQ(get_with("bearer " + token)->status, 200);
    EXPECT_EQ(get_with("Bearer   " + token)->status, 200);
  }
}

TEST_F(Tokens, AreAskedOfEverybodyElse) {
  const auto reply = get("/v1/solves");
  const json refusal = expect_problem(reply, 401);
  EXPECT_EQ(reply->get_header_value("WWW-Authenticate"), "Bearer");
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--token-file"), std::string::npos);
  for (const std::string& authorization :
       {std::string("Bearer"), std::string("Bearer "), "Bearer " + first_token + "0",
        "Bearer " + first_token.substr(0, 15), "Basic " + first_token, first_token,
        "Bearer " + first_token + first_token}) {
    expect_problem(get_with(authorization), 401);
  }
  expect_problem(post("instant"), 401);
  expect_problem(get("/nothing"), 401);
}

TEST_F(Tokens, AreNotNeededByProbesAndReaders) {
  for (const char* path : {"/healthz", "/readyz", "/", "/docs", "/openapi.json"}) {
    EXPECT_EQ(get(path)->status, 200) << path;
  }
}

TEST_F(Tokens, AreNotNeededForPages) {
  for (const char* path : {"/v1/solves", "/v1/solves/none", "/v1/examples/gap-sweep"}) {
    EXPECT_EQ(client_.Get(path, {{"Accept", "text/html"}})->status, 200) << path;
    expect_problem(client_.Get(path, {{"Accept", "application/json"}}), 401);
  }
  EXPECT_EQ(get("/v1/examples/gap-sweep/picture.svg")->status, 200);
}

/// No other route is open, as the README says.
TEST_F(Tokens, AreNeededForAllElse) {
  const std::set<std::string> open{"/",        "/docs",   "/pages/{file}", "/v1/examples/{name}/picture.svg",
                                   "/healthz", "/readyz", "/openapi.json"};
  for (const Route& route : service_.router().table()) {
    httplib::Request request;
    request.method = route.method;
    request.path = route.pattern;
    std::erase_if(request.path, [](char c) { return c == '{' || c == '}'; });
    const auto reply = client_.send(request);
    ASSERT_TRUE(reply) << route.method << ' ' << route.pattern;
    EXPECT_EQ(reply->status != 401, open.contains(route.pattern)) << route.method << ' ' << route.pattern;
  }
}

TEST_F(Tokens, AreAskedOfThoseWhoAskForOptions) {
  expect_problem(client_.Options("/v1/solves"), 401);
  EXPECT_EQ(client_.Options("/v1/solves", {{"Authorization", "Bearer " + first_token}})->status, 204);
  EXPECT_EQ(client_.Options("/docs")->status, 204);
  EXPECT_EQ(client_.Options("/healthz")->status, 204);
}

TEST(TokenFiles, MustHoldGoodTokens) {
  EXPECT_THROW(BearerTokens("/nonexistent"), BadTokenFile);
  for (const char* text :
       {"", "\n\n", "short\n", "a token with blanks in it\n", "0123456789abcdef\nshort\n",
        "two 0123456789abcdef\n", "a write 0123456789abcdef\n", "a/b read 0123456789abcdef\n",
        "a read 0123456789abcdef queue=0\n", "a read 0123456789abcdef memory=much\n",
        "a read 0123456789abcdef speed=1\n", "a read 0123456789abcdef\nb read 0123456789abcdef\n",
        "a read 0123456789abcdef rate=1\na read 0123456789abcdeg rate=2\n"}) {
    EXPECT_THROW(BearerTokens(token_file(text)), BadTokenFile) << text;
  }
}

TEST(Loopback, IsThisMachine) {
  for (const char* host : {"127.0.0.1", "127.8.9.1", "::1", "localhost"})
    EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* host : {"0.0.0.0", "10.0.0.1", "::", "example.org", "", "127.0.0.1.example.org"}) {
    EXPECT_FALSE(is_loopback(host)) << host;
  }
}

TEST(Loopback, IsLeftOnlyWithTokensOrOnPurpose) {
  const std::vector<std::string> flags{"--host", "0.0.0.0", "--port", "0", "--data-dir", ":memory:"};
  ChildProcess bare(flags);
  EXPECT_EQ(bare.wait(60s), 2);
  EXPECT_NE(bare.standard_error().find("--token-file"), std::string::npos) << bare.standard_error();
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--insecure"}, {"--token-file", token_file()}}) {
    std::vector<std::string> all = flags;
    all.insert(all.end(), more.begin(), more.end());
    ChildProcess process(all);
    for (int i = 0; i < 6000 && process.standard_error().find("listening") == std::string::npos; ++i) {
      std::this_thread::sleep_for(10ms);
    }
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait(60s), 0) << more.front() << process.standard_error();
  }
}

TEST(RequestRate, LetsASecondsWorthThroughAtOnce) {
  RequestRate rate(5);
  const auto start = RequestRate::Clock::time_point() + 1h;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(rate.count("10.0.0.1", start).count(), 0);
  EXPECT_NEAR(rate.count("10.0.0.1", start).count(), 0.2, 1e-9);
  EXPECT_EQ(rate.count("10.0.0.2", start).count(), 0);
  EXPECT_EQ(rate.count("10.0.0.1", start + 200ms).count(), 0);
  EXPECT_GT(rate.count("10.0.0.1", start + 200ms).count(), 0);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(rate.count("10.0.0.1", start + 1h).count(), 0);
  EXPECT_GT(rate.count("10.0.0.1", start + 1h).count(), 0);
}

TEST(RequestRate, CountsANetworkOfIpv6AsOneClient) {
  RequestRate rate(1);
  const auto start = RequestRate::Clock::time_point() + 1h;
  EXPECT_EQ(rate.count("2001:db8::1", start).count(), 0);
  EXPECT_GT(rate.count("2001:db8::2", start).count(), 0);
  EXPECT_EQ(rate.count("2001:db8:0:1::1", start).count(), 0);
}

class Rate : public ServiceTest {
 protected:
  Rate() : ServiceTest(options()) {}

  static ServiceOptions options() {
    ServiceOptions options;
    options.rate = 0.01;
    return options;
  }
};

TEST_F(Rate, AboveTheLimitIs429) {
  EXPECT_EQ(get("/v1/solves")->status, 200);
  const auto reply = get("/v1/solves");
  const json refusal = expect_problem(reply, 429);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("0.01 requests a second"), std::string::npos)
      << refusal;
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--rate"), std::string::npos);
  const int seconds = std::stoi(reply->get_header_value("Retry-After"));
  EXPECT_GT(seconds, 0);
  EXPECT_LE(seconds, 100);
  EXPECT_EQ(get("/healthz")->status, 200);
}

class Origins : public ServiceTest {
 protected:
  Origins() : ServiceTest(options()) {}

  static ServiceOptions options() {
    ServiceOptions options;
    options.cors_origins = {"https://good.example"};
    options.token_file = token_file();
    return options;
  }
};

TEST_F(Origins, ThatAreLetInMayReadRepliesAndRefusals) {
  const auto reply = client_.Get(
      "/v1/solves", {{"Origin", "https://good.example"}, {"Authorization", "Bearer " + first_token}});
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->get_header_value("Access-Control-Allow-Origin"), "https://good.example");
  const auto refusal = client_.Get("/v1/solves", {{"Origin", "https://good.example"}});
  EXPECT_EQ(refusal->status, 401);
  EXPECT_EQ(refusal->get_header_value("Access-Control-Allow-Origin"), "https://good.example");
  EXPECT_FALSE(client_.Get("/healthz", {{"Origin", "https://bad.example"}})
                   ->has_header("Access-Control-Allow-Origin"));
}

TEST_F(Origins, MayAskBefore) {
  const auto preflight = [&](const std::string& origin) {
    httplib::Request request;
    request.method = "OPTIONS";
    request.path = "/v1/solves/x";
    request.headers = {{"Origin", origin}, {"Access-Control-Request-Method", "DELETE"}};
    return client_.send(request);
  };
  const auto reply = preflight("https://good.example");
  EXPECT_EQ(reply->status, 204);
  EXPECT_EQ(reply->get_header_value("Access-Control-Allow-Methods"), "GET, HEAD, DELETE");
  EXPECT_EQ(reply->get_header_value("Access-Control-Allow-Origin"), "https://good.example");
  EXPECT_NE(reply->get_header_value("Access-Control-Allow-Headers").find("Authorization"), std::string::npos);
  EXPECT_EQ(preflight("https://bad.example")->status, 401);
}

class OnLoopback : public ServiceTest {
 protected:
  OnLoopback() : ServiceTest(options()) {}

  static ServiceOptions options() {
    ServiceOptions options;
    options.hosts = KnownHosts({"Proxied.example"});
    options.cors_origins = {"https://good.example"};
    return options;
  }

  int status_with(const httplib::Headers& headers, const std::string& path = "/v1/solves") {
    return client_.Get(path, headers)->status;
  }
};

TEST_F(OnLoopback, OtherNamesAreRefused) {
  for (const char* host : {"localhost", "LocalHost:8080", "127.0.0.1", "127.1.2.3:80", "[::1]:8080",
                           "proxied.example", "PROXIED.example:443"}) {
    EXPECT_EQ(status_with({{"Host", host}}), 200) << host;
  }
  for (const char* host :
       {"rebound.example", "rebound.example:8080", "128.0.0.1", "localhost.rebound.example",
        "127.0.0.1.rebound.example", "[::2]", "10.0.0.1", "0.0.0.0"}) {
    expect_problem(client_.Get("/v1/solves", {{"Host", host}}), 421);
    EXPECT_EQ(status_with({{"Host", host}}, "/"), 421) << host;
  }
  const std::string absolute = send_raw(
      service_.port(),
      "GET http://rebound.example/v1/solves HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  EXPECT_TRUE(absolute.starts_with("HTTP/1.1 421 ")) << absolute;
}

TEST_F(OnLoopback, PagesOfOtherOriginsAreRefused) {
  const httplib::Headers own{{"Host", "localhost:8080"}, {"Origin", "http://localhost:8080"}};
  EXPECT_EQ(status_with(own), 200);
  EXPECT_EQ(status_with({{"Host", "localhost"}, {"Origin", "https://good.example"}}), 200);
  for (const char* origin :
       {"https://bad.example", "null", "http://localhost:3000", "http://localhost.bad.example:8080"}) {
    expect_problem(client_.Get("/v1/solves", {{"Host", "localhost:8080"}, {"Origin", origin}}), 403);
  }
}

class NoOrigins : public ServiceTest {};

TEST_F(NoOrigins, AreLetInByDefault) {
  EXPECT_FALSE(client_.Get("/healthz", {{"Origin", "https://good.example"}})
                   ->has_header("Access-Control-Allow-Origin"));
}

TEST(MemoryBudget, CountsTheLargestThatMayRunTogether) {
  MemoryBudget budget(10, 2);
  budget.admit("a", 4);
  budget.admit("b", 5);
  budget.admit("c", 5);
  EXPECT_THROW(budget.admit("d", 6), MemoryFull);
  EXPECT_FALSE(budget.knows("d"));
  budget.release("b");
  budget.release("c");
  budget.admit("d", 6);
  EXPECT_THROW(budget.admit("e", 5), MemoryFull);
}

class Memory : public ServiceTest {
 protected:
  Memory() : ServiceTest(options()) {}

  /// For one small problem at a time, which is predicted to take some 5 MB, most of it for the history.
  static ServiceOptions options() {
    ServiceOptions options;
    options.max_memory = 8e6;
    options.limits.max_unknowns = 1'000'000;
    options.limits.max_memory = 8e6;
    return options;
  }
};

TEST_F(Memory, ThatIsSpokenForIs503UntilASolveEnds) {
  const std::string id = submit("slow");
  const auto reply = post("slow");
  const json refusal = expect_problem(reply, 503);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--max-memory"), std::string::npos) << refusal;
  EXPECT_NE(refusal.at("detail").get<std::string>().find("0.008 GB"), std::string::npos) << refusal;
  EXPECT_FALSE(reply->get_header_value("Retry-After").empty());
  client_.Delete("/v1/solves/" + id);
  wait_for(id, "cancelled");
  int status = 503;
  EXPECT_TRUE(becomes([&] {
    status = post("instant")->status;
    return status != 503;
  }));
  EXPECT_EQ(status, 202);
}

TEST_F(Memory, IsNotAskedForWhatIsThereAlready) {
  const auto send = [&] {
    return client_.Post("/v1/solves", {{"Idempotency-Key", "again"}}, problem_titled("slow"),
                        "application/json");
  };
  const std::string id = json::parse(send()->body).at("id");
  wait_for(id, "running");
  const auto again = send();
  ASSERT_EQ(again->status, 202) << again->body;
  EXPECT_EQ(json::parse(again->body).at("id"), id);
  client_.Delete("/v1/solves/" + id);
}

TEST_F(Memory, ThatNoSolveMayTakeIs413) {
  json problem = json::parse(problem_titled("instant"));
  problem["mesh"]["divisions"] = {200, 200};
  for (const char* path : {"/v1/solves", "/v1/validate"}) {
    const json refusal = expect_problem(client_.Post(path, problem.dump(), "application/json"), 413);
    EXPECT_NE(refusal.at("detail").get<std::string>().find("--max-memory"), std::string::npos) << refusal;
  }
}

}  // namespace
}  // namespace signorini::server::access_test
