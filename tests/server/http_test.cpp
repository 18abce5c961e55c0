#include <random>

#include "running_service.hpp"

namespace signorini::server::http_test {
namespace {

using nlohmann::json;

class Http : public ServiceTest {};

TEST_F(Http, UnknownPathsAre404) {
  for (const char* path : {"/nothing", "/v1/solves/", "/v1/solves/00000000000000000000000000",
                           "/v1/examples/none", "/v1//solves", "/v1/solves/a%0Ab"}) {
    expect_problem(get(path), 404);
  }
}

TEST_F(Http, WrongMethodsAre405WithAllow) {
  const auto reply = client_.Put("/v1/solves", "{}", "application/json");
  expect_problem(reply, 405);
  EXPECT_EQ(reply->get_header_value("Allow"), "POST, GET, HEAD, DELETE, OPTIONS");
  expect_problem(client_.Patch("/v1/validate", "{}", "application/json"), 405);
  expect_problem(client_.Delete("/healthz"), 405);
  EXPECT_NE(
      send_raw(service_.port(), "TRACE / HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n").find(" 405 "),
      std::string::npos);
}

TEST_F(Http, OptionsAre204WithAllow) {
  const auto reply = client_.Options("/v1/solves/x");
  EXPECT_EQ(reply->status, 204);
  EXPECT_EQ(reply->get_header_value("Allow"), "GET, HEAD, DELETE, OPTIONS");
  expect_problem(client_.Options("/nothing"), 404);
}

TEST_F(Http, HeadIsGetWithoutABody) {
  const auto reply = client_.Head("/v1/examples");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_TRUE(reply->body.empty());
  EXPECT_EQ(reply->get_header_value("Content-Length"), std::to_string(get("/v1/examples")->body.size()));
}

TEST_F(Http, AnAcceptThatExcludesJsonIs406) {
  expect_problem(client_.Get("/v1/solves", {{"Accept", "text/csv"}}), 406);
  EXPECT_EQ(client_.Get("/v1/solves", {{"Accept", "text/csv, */*;q=0.1"}})->status, 200);
}

TEST_F(Http, AnEmptyAcceptTakesEverything) {
  EXPECT_EQ(client_.Get("/v1/solves", {{"Accept", ""}})->status, 200);
}

TEST_F(Http, ABodyThatIsNotJsonIs415) {
  expect_problem(client_.Post("/v1/solves", problem_titled("instant"), "text/plain"), 415);
  expect_problem(client_.Post("/v1/solves", problem_titled("instant"), "multipart/form-data; boundary=x"),
                 415);
  EXPECT_EQ(client_.Post("/v1/solves", problem_titled("instant"), "application/problem+json; charset=utf-8")
                ->status,
            202);
  const std::string untyped =
      send_raw(service_.port(),
               "POST /v1/solves HTTP/1.1\r\nHost: h\r\nConnection: close\r\nContent-Length: 2\r\n\r\n{}");
  EXPECT_NE(untyped.find(" 415 "), std::string::npos) << untyped;
  EXPECT_NE(untyped.find("curl -H"), std::string::npos) << untyped;
}

TEST_F(Http, ABodyThatCannotBeReadIs400Or422) {
  expect_problem(client_.Post("/v1/solves", "{\"model\": ", "application/json"), 400);
  expect_problem(client_.Post("/v1/solves", "", "application/json"), 400);
  const json problem = expect_problem(client_.Post("/v1/solves", "{}", "application/json"), 422);
  EXPECT_FALSE(problem.at("errors").empty());
  for (const json& error : problem.at("errors")) EXPECT_TRUE(error.contains("pointer")) << error;
}

TEST_F(Http, ABodyOverTheLimitIs413HoweverItIsSent) {
  const std::string large((1 << 20) + 1, ' ');
  expect_problem(client_.Post("/v1/solves", large, "application/json"), 413);

  const auto chunks = [&](std::size_t offset, httplib::DataSink& sink) {
    if (offset < large.size())
      return sink.write(large.data() + offset, std::min<std::size_t>(50'000, large.size() - offset));
    sink.done();
    return true;
  };
  expect_problem(client_.Post("/v1/solves", chunks, "application/json"), 413);

  httplib::Client compressing("127.0.0.1", service_.port());
  compressing.set_compress(true);
  expect_problem(compressing.Post("/v1/solves", std::string(64 << 20, ' '), "application/json"), 413);
  EXPECT_EQ(get("/healthz")->status, 200);
}

TEST_F(Http, ABodyUpToTheLimitIsTakenHoweverItIsSent) {
  // By blanks that are no hundredth of their length when they are compressed.
  std::string padded = problem_titled("instant");
  std::mt19937 engine(1);
  while (padded.size() < 1 << 20) padded += " \n\t\r"[engine() % 4];
  EXPECT_EQ(client_.Post("/v1/solves?wait=60", padded, "application/json")->status, 200);

  const auto chunks = [&](std::size_t offset, httplib::DataSink& sink) {
    if (offset < padded.size())
      return sink.write(padded.data() + offset, std::min<std::size_t>(50'000, padded.size() - offset));
    sink.done();
    return true;
  };
  EXPECT_EQ(client_.Post("/v1/solves?wait=60", chunks, "application/json")->status, 200);

  httplib::Client compressing("127.0.0.1", service_.port());
  compressing.set_compress(true);
  EXPECT_EQ(compressing.Post("/v1/solves?wait=60", padded, "application/json")->status, 200);
}

TEST_F(Http, ProblemsMayComeInCbor) {
  const auto post_cbor = [&](const json& problem, const char* path) {
    const std::vector<std::uint8_t> bytes = json::to_cbor(problem);
    return client_.Post(path, std::string(bytes.begin(), bytes.end()), "application/cbor");
  };
  json problem = json::parse(problem_titled("instant"));
  const auto reply = post_cbor(problem, "/v1/solves?wait=60&fields=problem");
  ASSERT_EQ(reply->status, 200);
  EXPECT_EQ(json::parse(reply->body).at("problem"), problem);

  problem["mesh"]["divisions"] = {4, -1};
  const json refusal = expect_problem(post_cbor(problem, "/v1/solves"), 422);
  EXPECT_EQ(refusal.at("errors").at(0).at("pointer"), "/mesh/divisions/1");
  const json malformed = expect_problem(client_.Post("/v1/solves", "\x81", "application/cbor"), 400);
  EXPECT_EQ(malformed.at("title"), "The body is not CBOR");
  // Half a million bytes that are two million as JSON.
  const std::string large =
      "\xd8\x48\x5a" + std::string("\x00\x08\x00\x00", 4) + std::string(0x80000, '\x80');
  expect_problem(client_.Post("/v1/solves", large, "application/cbor"), 413);
}

TEST_F(Http, UnknownCodingsOfABodyAre415) {
  expect_problem(
      client_.Post("/v1/solves", {{"Content-Encoding", "br"}}, problem_titled("instant"), "application/json"),
      415);
  expect_problem(client_.Post("/v1/solves", {{"Content-Encoding", "gzip"}}, "not gzip", "application/json"),
                 400);
}

TEST_F(Http, TooLongASweepIs413) {
  json problem = json::parse(problem_titled("sweep"));  // four contact unknowns
  problem["sweep"] = json(250, json::object());
  EXPECT_EQ(client_.Post("/v1/validate", problem.dump(), "application/json")->status, 200);
  problem["sweep"].push_back(json::object());
  const json refusal = expect_problem(client_.Post("/v1/solves", problem.dump(), "application/json"), 413);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("251 entries"), std::string::npos);
  EXPECT_EQ(refusal.at("errors").at(0).at("pointer"), "/sweep");
}

TEST_F(Http, StudiesAreSolvesThatMustHaveAStudy) {
  const json refusal =
      expect_problem(client_.Post("/v1/studies", problem_titled("instant"), "application/json"), 422);
  EXPECT_EQ(refusal.at("errors").at(0).at("pointer"), "/study");
  json problem = json::parse(problem_titled("instant"));
  problem["study"] = {{"divisions", {2, 4}}};
  const auto reply = client_.Post("/v1/studies?wait=60&fields=study", problem.dump(), "application/json");
  ASSERT_EQ(reply->status, 200);
  const std::string path = reply->get_header_value("Location");
  EXPECT_EQ(path, "/v1/solves/" + json::parse(reply->body).at("id").get<std::string>());
  // The scripted solver knows no studies.
  expect_problem(get(path + "/study.csv"), 404);
}

TEST_F(Http, TooLongAStudyIs413) {
  json problem = json::parse(problem_titled("study"));
  problem["study"] = {{"divisions", {8, 8, 8, 8}}};  // 208 stress unknowns each
  const auto estimated = client_.Post("/v1/validate", problem.dump(), "application/json");
  EXPECT_EQ(json::parse(estimated->body).at("study_runs"), 4);
  problem["study"]["schemes"] = {"nonconforming", "conforming"};
  const json refusal = expect_problem(client_.Post("/v1/studies", problem.dump(), "application/json"), 413);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("8 runs"), std::string::npos);
  EXPECT_EQ(refusal.at("errors").at(0).at("pointer"), "/study");
}

TEST_F(Http, TooManyUnknownsAre413) {
  json problem = json::parse(problem_titled("instant"));
  problem["mesh"]["divisions"] = {100, 100};
  const json refusal = expect_problem(client_.Post("/v1/solves", problem.dump(), "application/json"), 413);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--max-unknowns"), std::string::npos);
  EXPECT_EQ(refusal.at("errors").at(0).at("pointer"), "/mesh");
}

TEST_F(Http, ConflictingOrMalformedLengthsAre400) {
  const std::string head = "POST /v1/solves HTTP/1.1\r\nHost: h\r\nContent-Type: application/json\r\n";
  for (const char* framing :
       {"Content-Length: 2\r\nTransfer-Encoding: chunked", "Content-Length: 2\r\nContent-Length: 3",
        "Content-Length: two", "Content-Length: -1", "Content-Length: 2, 2", "Transfer-Encoding: gzip"}) {
    const std::string reply = send_raw(service_.port(), head + framing + "\r\n\r\n{}");
    EXPECT_NE(reply.find("HTTP/1.1 400 "), std::string::npos) << framing << reply;
    EXPECT_NE(reply.find("Connection: close"), std::string::npos) << framing;
    EXPECT_NE(reply.find("application/problem+json"), std::string::npos) << framing;
  }
}

TEST_F(Http, ABodyNobodyReadsIsNotTakenForTheNextRequest) {
  const std::string smuggled = "GET /v1/examples HTTP/1.1\r\nHost: h\r\n\r\n";
  for (const char* line : {"GET /healthz", "DELETE /v1/solves/x", "PUT /v1/solves", "POST /nothing"}) {
    const std::string reply =
        send_raw(service_.port(), std::string(line) + " HTTP/1.1\r\nHost: h\r\nContent-Length: " +
                                      std::to_string(smuggled.size()) + "\r\n\r\n" + smuggled);
    EXPECT_EQ(reply.find("paper-nonconforming"), std::string::npos) << line;
  }
}

TEST_F(Http, PipelinedRequestsAreAnsweredInOrder) {
  const std::string reply = send_raw(service_.port(),
                                     "GET /healthz HTTP/1.1\r\nHost: h\r\n\r\n"
                                     "GET /readyz HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n");
  const std::size_t first = reply.find("\"ok\"");
  const std::size_t second = reply.find("\"ready\"");
  ASSERT_NE(first, std::string::npos) << reply;
  ASSERT_NE(second, std::string::npos) << reply;
  EXPECT_LT(first, second);
}

TEST_F(Http, GarbageAndEndlessHeadsAreProblemsToo) {
  for (const std::string& bytes :
       {std::string("HELLO\r\n\r\n"), "GET /" + std::string(10'000, 'a') + " HTTP/1.1\r\nHost: h\r\n\r\n",
        "GET / HTTP/1.1\r\nX: " + std::string(10'000, 'a') + "\r\n\r\n",
        std::string("GET / HTTP/1.1\r\nRange: bytes=abc\r\n\r\n")}) {
    const std::string reply = send_raw(service_.port(), bytes);
    EXPECT_EQ(reply.rfind("HTTP/1.1 4", 0), 0u) << bytes.substr(0, 30) << reply;
    EXPECT_NE(reply.find("application/problem+json"), std::string::npos) << bytes.substr(0, 30);
    EXPECT_NE(reply.find("X-Request-Id"), std::string::npos) << bytes.substr(0, 30);
  }
  std::string many = "GET /healthz HTTP/1.1\r\n";
  for (int i = 0; i < 20'000; ++i) many += "X-" + std::to_string(i) + ": y\r\n";
  EXPECT_EQ(send_raw(service_.port(), many + "\r\n").find("\"ok\""), std::string::npos);
}

TEST_F(Http, RangesAreNotApplied) {
  const auto reply = client_.Get("/v1/examples", {{"Range", "bytes=0-3,5-6"}});
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->body, get("/v1/examples")->body);
}

TEST_F(Http, BrotliIsNeverUsed) {
  EXPECT_FALSE(client_.Get("/v1/examples", {{"Accept-Encoding", "br"}})->has_header("Content-Encoding"));
}

TEST_F(Http, TheRequestIdIsKeptIfSane) {
  const auto id_for = [&](const std::string& id) {
    return client_.Get("/healthz", {{"X-Request-Id", id}})->get_header_value("X-Request-Id");
  };
  EXPECT_EQ(id_for("trace-17"), "trace-17");
  EXPECT_NE(id_for(std::string(65, 'a')), std::string(65, 'a'));
  EXPECT_EQ(id_for(std::string(64, 'a')), std::string(64, 'a'));
  EXPECT_EQ(id_for("a%0d%0aSet-Cookie: x").find("Set-Cookie"), std::string::npos);
  EXPECT_EQ(get("/healthz")->get_header_value("X-Request-Id").size(), 26u);
}

TEST_F(Http, ExamplesCanBePosted) {
  const json list = json::parse(get("/v1/examples")->body);
  ASSERT_FALSE(list.at("examples").empty());
  for (const json& example : list.at("examples")) {
    const auto problem = get(example.at("links").at("self"));
    ASSERT_TRUE(problem);
    const auto reply = client_.Post("/v1/validate", problem->body, "application/json");
    ASSERT_TRUE(reply);
    EXPECT_TRUE(reply->status == 200 || reply->status == 413) << example << reply->body;
  }
}

}  // namespace
}  // namespace signorini::server::http_test
