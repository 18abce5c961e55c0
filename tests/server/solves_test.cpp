#include "running_service.hpp"

#include <algorithm>
#include <thread>

#include "becomes.hpp"
#include "raw_client.hpp"

namespace signorini::server::solves_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

class Solves : public ServiceTest {};

TEST_F(Solves, AreAcceptedWithAStatusDocument) {
  const auto reply = post("slow");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 202);
  const json document = json::parse(reply->body);
  const std::string id = document.at("id");
  EXPECT_EQ(reply->get_header_value("Location"), "/v1/solves/" + id);
  for (const char* member : {"id", "status", "title", "created_at", "started_at", "finished_at", "progress",
                             "summary", "error", "links"}) {
    EXPECT_TRUE(document.contains(member)) << member;
  }
  EXPECT_EQ(document.at("title"), "slow");
  EXPECT_EQ(document.at("links").at("result"), "/v1/solves/" + id + "/result");
}

TEST_F(Solves, ShowProgressAndHistoryWhileRunning) {
  const std::string id = submit("slow");
  json progress{{"iteration", 0}};
  EXPECT_TRUE(becomes([&] {
    progress = status_of(id).at("progress");
    return progress.at("iteration") >= 3;
  }));
  EXPECT_EQ(progress.at("phase"), "iterate");
  json history;
  EXPECT_TRUE(becomes([&] {
    history = json::parse(get("/v1/solves/" + id + "/history")->body);
    return history.at("history").at("iteration").size() >= 3;
  }));
  EXPECT_EQ(history.at("status"), "running");
  expect_problem(get("/v1/solves/" + id + "/result"), 409);
}

TEST_F(Solves, AnswerAWaitWithTheResult) {
  const auto reply = post("short", "?wait=60&fields=summary");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200) << reply->body;
  const json result = json::parse(reply->body);
  EXPECT_EQ(result.at("status"), "succeeded");
  EXPECT_EQ(result.at("summary").at("outcome"), "converged");
  EXPECT_FALSE(result.contains("mesh"));
  EXPECT_FALSE(result.contains("history"));
  EXPECT_FALSE(result.contains("error"));
}

TEST_F(Solves, AnswerAWaitThatIsTooShortWithTheStatus) {
  // How soon a solve begins elsewhere in a fleet is up to the machine; the first must begin at some time.
  json status;
  for (const char* wait : {"?wait=0.5", "?wait=5", "?wait=50"}) {
    const auto reply = post("slow", wait);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 202);
    status = json::parse(reply->body).at("status");
    if (status == "running") break;
    EXPECT_EQ(status, "queued");
    client_.Delete("/v1/solves/" + std::string(json::parse(reply->body).at("id")));
  }
  EXPECT_EQ(status, "running");
}

TEST_F(Solves, HonourThePreferHeader) {
  const auto preferring = [&](const std::string& prefer, const std::string& title) {
    return client_.Post("/v1/solves", {{"Prefer", prefer}}, problem_titled(title), "application/json");
  };
  for (const char* prefer : {"respond-async, wait=5", R"(Wait = "5", wait=0)"}) {
    const auto reply = preferring(prefer, "short");
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 200) << prefer;
    EXPECT_EQ(reply->get_header_value("Preference-Applied"), "wait=5") << prefer;
  }
  EXPECT_EQ(preferring("wait=99999999999999999999", "instant")->get_header_value("Preference-Applied"),
            "wait=3600");
  for (const char* prefer : {R"(foo="a,wait=5")", "wait=5s", "wait=soon, wait=5"}) {
    const auto reply = preferring(prefer, "instant");
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 202) << prefer;
    EXPECT_FALSE(reply->has_header("Preference-Applied")) << prefer;
  }
}

TEST_F(Solves, ServeTheLastIterateOfAMethodThatDiverged) {
  const auto reply = post("diverges", "?wait=60");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  const json result = json::parse(reply->body);
  EXPECT_EQ(result.at("status"), "failed");
  EXPECT_EQ(result.at("summary").at("outcome"), "diverged");
  EXPECT_EQ(result.at("history").at("iteration").size(), 3u);
  const json status = status_of(result.at("id"));
  EXPECT_EQ(status.at("error").at("detail"), "take a smaller rho");
  EXPECT_EQ(result.value("error", json()), status.at("error"));
  EXPECT_EQ(get("/v1/solves/" + std::string(result.at("id")) + "/result")->status, 200);
}

TEST_F(Solves, ThatFailSayWhy) {
  const json no_solution = json::parse(post("no solution", "?wait=60")->body);
  EXPECT_EQ(no_solution.at("status"), "failed");
  EXPECT_EQ(no_solution.at("error").at("detail"), "nothing holds the body");

  const json not_finite = json::parse(post("not finite", "?wait=60")->body);
  EXPECT_EQ(not_finite.at("error").at("errors").at(0).at("pointer"), "/load/body");

  const json no_memory = json::parse(post("no memory", "?wait=60")->body);
  EXPECT_EQ(no_memory.at("error").at("title"), "Out of memory");
  expect_problem(get("/v1/solves/" + std::string(no_memory.at("id")) + "/result"), 410);
}

TEST_F(Solves, NeverLeakAnException) {
  const auto reply = post("throws", "?wait=60");
  ASSERT_TRUE(reply);
  EXPECT_EQ(json::parse(reply->body).at("status"), "failed");
  EXPECT_EQ(reply->body.find("secret"), std::string::npos);
  for (const auto& [name, value] : reply->headers) {
    EXPECT_NE(name, "EXCEPTION_WHAT");
    EXPECT_EQ(value.find("secret"), std::string::npos);
  }
}

TEST_F(Solves, AreCancelledWhileRunning) {
  const std::string id = submit("slow");
  wait_for(id, "running");
  const auto reply = client_.Delete("/v1/solves/" + id);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 202);
  const json document = wait_for(id, "cancelled");
  EXPECT_TRUE(document.at("finished_at").is_string());
  EXPECT_EQ(json::parse(get("/v1/solves/" + id + "/history")->body).at("status"), "cancelled");
}

/// In a fleet it takes up to a second until another service hears of it. The machine may be busy for a while.
TEST_F(Solves, AreCancelledSoon) {
  std::chrono::duration<double> least = std::chrono::hours(1);
  for (int i = 0; i < 5 && least > 2s; ++i) {
    const std::string id = submit("slow");
    wait_for(id, "running");
    const auto begin = std::chrono::steady_clock::now();
    client_.Delete("/v1/solves/" + id);
    wait_for(id, "cancelled");
    least = std::min<std::chrono::duration<double>>(least, std::chrono::steady_clock::now() - begin);
  }
  EXPECT_LT(least, 2s);
}

TEST_F(Solves, ThatRefineShowTheirLevelAndKeepItWhenCancelled) {
  const std::string id = submit("refines");
  json progress;
  ASSERT_TRUE(becomes([&] {
    progress = status_of(id).at("progress");
    return progress.contains("level");
  }));
  const json level = progress.at("level");
  EXPECT_EQ(level.at("triangles"), 100 * level.at("number").get<int>());
  EXPECT_EQ(level.at("relative"), 0.25);
  client_.Delete("/v1/solves/" + id);
  const json document = wait_for(id, "cancelled");
  EXPECT_EQ(document.at("summary").at("outcome"), "cancelled");
  EXPECT_EQ(document.at("error").at("detail"), "the relative error bound is 0.25 and 0.1 was asked for");
  const auto result = get("/v1/solves/" + id + "/result?fields=summary");
  EXPECT_EQ(result->status, 200);
  EXPECT_EQ(json::parse(result->body).at("status"), "cancelled");
}

TEST_F(Solves, AreCancelledWhileQueued) {
  submit("slow");
  submit("slow");
  const std::string id = submit("instant");
  const auto reply = client_.Delete("/v1/solves/" + id);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 202);
  EXPECT_EQ(json::parse(reply->body).at("status"), "cancelled");
  expect_problem(get("/v1/solves/" + id + "/result"), 410);
}

/// A client that posts `slow`, waits for it and leaves.
void post_and_leave(int port, const std::string& query) {
  const std::string body = problem_titled("slow");
  RawClient client(port);
  client.send("POST /v1/solves" + query +
              " HTTP/1.1\r\nHost: h\r\nContent-Type: application/json\r\nContent-Length: " +
              std::to_string(body.size()) + "\r\n\r\n" + body);
  httplib::Client watcher("127.0.0.1", port);
  EXPECT_TRUE(becomes(
      [&] { return !json::parse(watcher.Get("/v1/solves?status=running")->body).at("solves").empty(); }));
}

TEST_F(Solves, AreCancelledWithTheirClientIfItSaidSo) {
  post_and_leave(service_.port(), "?wait=60&cancel=disconnect");
  const json solve = json::parse(get("/v1/solves")->body).at("solves").at(0);
  wait_for(solve.at("id"), "cancelled");
}

TEST_F(Solves, OutliveTheirClientOtherwise) {
  post_and_leave(service_.port(), "?wait=60");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(json::parse(get("/v1/solves")->body).at("solves").at(0).at("status"), "running");
  service_.stop();
}

TEST_F(Solves, AreNotCancelledWhileTheirClientWaits) {
  const auto reply = post("short", "?wait=20&cancel=disconnect&fields=summary");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(json::parse(reply->body).at("status"), "succeeded");
}

TEST_F(Solves, AreRemovedOnceEnded) {
  const std::string id = json::parse(post("instant", "?wait=60")->body).at("id");
  const auto reply = client_.Delete("/v1/solves/" + id);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 204);
  expect_problem(get("/v1/solves/" + id), 404);
  expect_problem(client_.Delete("/v1/solves/" + id), 404);
}

TEST_F(Solves, AreLeftByADeleteWhoseConditionDoesNotHold) {
  const std::string ended =
      "/v1/solves/" + std::string(json::parse(post("instant", "?wait=60")->body).at("id"));
  const std::string id = submit("slow");
  const std::string running = "/v1/solves/" + id;
  wait_for(id, "running");
  for (const char* condition : {"\"x\"", "W/\"x\"", "\"x\", \"y\"", "*, \"x\"", "x", ""}) {
    const httplib::Headers headers{{"If-Match", condition}};
    for (const std::string& path : {ended, running}) {
      const json refusal = expect_problem(client_.Delete(path, headers), 412);
      EXPECT_NE(refusal.value("detail", "").find("If-Match"), std::string::npos) << refusal;
    }
  }
  EXPECT_EQ(get(ended)->status, 200);
  EXPECT_EQ(status_of(id).at("status"), "running");
  expect_problem(client_.Delete("/v1/solves/0", {{"If-Match", "\"x\""}}), 404);
  EXPECT_EQ(client_.Delete(ended, {{"If-Match", "*"}})->status, 204);
  EXPECT_EQ(client_.Delete(running, {{"If-Match", "*"}})->status, 202);
}

/// RFC 9110, 13.2.1: whatever is asked for, and done with it.
TEST_F(Solves, AreAnsweredUnderTheConditionsOfTheRequest) {
  const std::string own =
      "/v1/solves/" + std::string(json::parse(post("instant", "?wait=60")->body).at("id"));
  const httplib::Headers other{{"If-Match", "\"x\""}}, missing{{"If-None-Match", "*"}},
      any{{"If-Match", "*"}}, none{{"If-None-Match", "\"x\""}};
  for (const std::string& path :
       {own, own + "/result", own + "/events", std::string("/v1/solves"), std::string("/openapi.json")}) {
    expect_problem(client_.Get(path, other), 412);
    std::vector<RawClient> known;
    known.emplace_back(service_.port());
    known[0].send("GET " + path +
                  " HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: *\r\nConnection: close\r\n\r\n");
    EXPECT_TRUE(listen_until(known, 60s, [&] { return known[0].closed(); })) << path;
    EXPECT_EQ(known[0].status(), 304) << path;
    EXPECT_EQ(known[0].heard().find("\r\n\r\n") + 4, known[0].heard().size()) << "a 304 has no body";
    EXPECT_EQ(client_.Get(path, any)->status, 200) << path;
    EXPECT_EQ(client_.Get(path, none)->status, 200) << path;
  }
  for (const httplib::Headers& condition : {other, missing}) {
    expect_problem(client_.Get("/v1/solves/0", condition), 404);
    expect_problem(client_.Delete("/v1/solves/0", condition), 404);
    expect_problem(client_.Delete(own, condition), 412);
    expect_problem(client_.Delete("/v1/solves?tag=none&confirm=0", condition), 412);
    expect_problem(client_.Post("/v1/solves", condition, problem_titled("instant"), "application/json"), 412);
    expect_problem(client_.Post("/v1/batches", condition, "[]", "application/json"), 412);
  }
  EXPECT_EQ(json::parse(get("/v1/solves")->body).at("solves").size(), 1u);
}

TEST_F(Solves, AreRefusedWhenTheQueueIsFull) {
  for (int i = 0; i < 6; ++i) {
    wait_for(submit("slow"), i < 2 ? "running" : "queued");
  }
  const auto reply = post("instant");
  expect_problem(reply, 503);
  EXPECT_FALSE(reply->get_header_value("Retry-After").empty());
}

TEST_F(Solves, AreRefusedWhileStopping) {
  service_.scheduler().stop();
  const auto reply = post("instant");
  expect_problem(reply, 503);
  EXPECT_FALSE(reply->get_header_value("Retry-After").empty());
  expect_problem(get("/readyz"), 503);
  EXPECT_EQ(get("/healthz")->status, 200);
}

TEST_F(Solves, AreListedNewestFirstInPages) {
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(json::parse(post("instant", "?wait=60")->body).at("id"));
  std::vector<std::string> listed;
  for (json next = "/v1/solves?limit=2&status=succeeded"; next.is_string();) {
    const json page = json::parse(get(next)->body);
    EXPECT_LE(page.at("solves").size(), 2u);
    for (const json& solve : page.at("solves")) listed.push_back(solve.at("id"));
    next = page.at("links").at("next");
  }
  EXPECT_EQ(listed, (std::vector<std::string>(ids.rbegin(), ids.rend())));
  EXPECT_TRUE(json::parse(get("/v1/solves?status=failed")->body).at("solves").empty());
}

TEST_F(Solves, RefuseBadQueryValuesAndUnknownParameters) {
  for (const char* query :
       {"status=done", "limit=0", "limit=1001", "limit=ten", "after=x", "offset=1", "limit=1&limit=2"}) {
    const json problem = expect_problem(get(std::string("/v1/solves?") + query), 400);
    EXPECT_TRUE(problem.at("errors").at(0).contains("parameter")) << query;
  }
  for (const char* query : {"?wait=-1", "?wait=3601", "?wait=soon", "?fields=nonsense", "?sync=1",
                            "?cancel=disconnect", "?wait=1&cancel=yes"}) {
    expect_problem(post("instant", query), 400);
  }
  EXPECT_TRUE(json::parse(get("/v1/solves")->body).at("solves").empty());
}

TEST_F(Solves, RefuseParametersWithoutAValueAlike) {
  const auto expect_refusal = [](const httplib::Result& reply, const std::string& name) {
    const json fault = expect_problem(reply, 400).at("errors").at(0);
    EXPECT_EQ(fault.at("parameter"), name);
    EXPECT_EQ(fault.at("detail"), "`" + name + "` has no value: give it one, or leave it out.");
  };
  const std::string solve =
      "/v1/solves/" + std::string(json::parse(post("touches", "?wait=60")->body).at("id"));
  for (const std::string name : {"status", "tag", "title", "limit", "after"})
    expect_refusal(get("/v1/solves?" + name + "="), name);
  for (const std::string name : {"wait", "cancel", "fields"})
    expect_refusal(post("instant", "?" + name), name);
  for (const std::string name : {"field", "deformed"})
    expect_refusal(get(solve + "/picture.svg?" + name + "="), name);
  expect_refusal(get(solve + "/result?fields="), "fields");
  expect_refusal(client_.Delete("/v1/solves?tag=a&confirm="), "confirm");
}

TEST_F(Solves, AreValidatedWithoutASolve) {
  const auto reply = client_.Post("/v1/validate", problem_titled("slow"), "application/json");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200) << reply->body;
  EXPECT_EQ(json::parse(reply->body).at("triangles"), 32);
  expect_problem(client_.Post("/v1/validate", "{}", "application/json"), 422);
  EXPECT_TRUE(json::parse(get("/v1/solves")->body).at("solves").empty());
}

TEST_F(Solves, AreValidatedByWhatTheSolveRefuses) {
  const auto refused = [&](json problem, const std::string& word) {
    const auto reply = client_.Post("/v1/validate", problem.dump(), "application/json");
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 422) << reply->body;
    EXPECT_NE(reply->body.find(word), std::string::npos) << reply->body;
  };
  json block = {{"model", "elasticity"},
                {"domain", {{"type", "rectangle"}}},
                {"mesh", {{"divisions", {4, 4}}}},
                {"material", {{"young", 200}, {"poisson", 0.3}}},
                {"boundary", {{"bottom", {{"type", "contact"}}}}},
                {"scheme", "conforming"}};
  refused(block, "translation along (1, 0)");
  block["boundary"]["left"] = {{"type", "roller"}};
  refused(block, "translation along (0, 1)");
  block["load"]["body"] = {0, "1 - x"};
  refused(block, "lifts it off");
  block["load"]["body"] = {0, -1};
  EXPECT_EQ(client_.Post("/v1/validate", block.dump(), "application/json")->status, 200);
  block["mesh"]["adaptive"] = {{"tolerance", 0.1}, {"max_triangles", 20}};
  refused(block, "/mesh/adaptive/max_triangles");
}

TEST_F(Solves, StreamALargeResultPlainAndCompressed) {
  const std::string id = json::parse(post("large", "?wait=60&fields=summary")->body).at("id");
  const std::string path = "/v1/solves/" + id + "/result";
  const auto plain = client_.Get(path);
  ASSERT_TRUE(plain);
  EXPECT_EQ(json::parse(plain->body).at("history").at("iteration").size(), 100'000u);
  const auto compressed = client_.Get(path, {{"Accept-Encoding", "br, gzip"}});
  ASSERT_TRUE(compressed);
  EXPECT_EQ(compressed->get_header_value("Content-Encoding"), "gzip");
  EXPECT_EQ(compressed->body, plain->body);
}

TEST_F(Solves, AnswerHttp10WithoutChunks) {
  const std::string id = json::parse(post("instant", "?wait=60")->body).at("id");
  const std::string reply = send_raw(service_.port(), "GET /v1/solves/" + id + "/result HTTP/1.0\r\n\r\n");
  EXPECT_EQ(reply.find("chunked"), std::string::npos);
  const std::size_t body = reply.find("\r\n\r\n");
  ASSERT_NE(body, std::string::npos);
  EXPECT_TRUE(json::accept(reply.substr(body + 4))) << reply;
}

}  // namespace
}  // namespace signorini::server::solves_test
