#include "child_process.hpp"
#include "example_problems.hpp"
#include "running_service.hpp"

#include <cmath>
#include <csignal>
#include <map>
#include <sstream>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "api/examples.hpp"

namespace signorini::server::daemon_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr auto soon = sanitized ? 10s : 1s;  // the checks of a solve lie further apart under a sanitizer

class DaemonTest : public testing::Test {
 protected:
  DaemonTest() : client_("127.0.0.1", daemon_.port()) {
    client_.set_read_timeout(100);
    client_.set_tcp_nodelay(true);
  }

  httplib::Result post(const json& problem, const std::string& query) {
    return client_.Post("/v1/solves" + query, problem.dump(), "application/json");
  }

  json status_of(const std::string& id) { return json::parse(client_.Get("/v1/solves/" + id)->body); }

  std::string submit(const json& problem) { return json::parse(post(problem, "")->body).at("id"); }

  void wait_for_phase(const std::string& id, const std::string& phase) {
    const auto until = Clock::now() + 90s;
    while (Clock::now() < until) {
      if (status_of(id).at("progress").at("phase") == phase) return;
      std::this_thread::sleep_for(1ms);
    }
    ADD_FAILURE() << "never in " << phase << ": " << status_of(id);
  }

  Daemon daemon_;
  httplib::Client client_;
};

TEST_F(DaemonTest, SolvesEveryExample) {
  for (const api::Example& each : api::examples()) {
    const auto reply = post(json::parse(each.json), "?wait=100");
    ASSERT_TRUE(reply) << each.name;
    ASSERT_EQ(reply->status, 200) << each.name << reply->body.substr(0, 500);
    const json result = json::parse(reply->body);
    EXPECT_EQ(result.at("status"), "succeeded") << each.name << result.at("summary");
    for (const char* member :
         {"id", "problem", "summary", "mesh", "displacement", "stress", "contact", "history"}) {
      EXPECT_TRUE(result.contains(member)) << each.name << member;
    }
  }
}

/// Each entry is what the problem with its data gives, posted by itself; that finds the factor of the sweep.
TEST_F(DaemonTest, EntriesOfASweepAreSolvesOfTheirOwn) {
  json problem = example("gap-sweep");
  const json result = json::parse(post(problem, "?wait=60&fields=sweep,contact")->body);
  EXPECT_EQ(result.at("status"), "succeeded");
  EXPECT_FALSE(result.contains("stress"));
  const json sweep = problem.at("sweep");
  problem.erase("sweep");
  ASSERT_EQ(result.at("sweep").size(), sweep.size());
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const json& entry = result.at("sweep")[i];
    json single = problem;
    single.merge_patch(sweep[i]);
    const json alone = json::parse(post(single, "?wait=60")->body);
    EXPECT_EQ(entry.at("title"), single.at("title"));
    EXPECT_EQ(entry.at("status"), "succeeded");
    EXPECT_TRUE(alone.at("summary").at("reused").get<bool>());
    const double energy = alone.at("summary").at("energy");
    EXPECT_NEAR(entry.at("summary").at("energy").get<double>(), energy, 1e-10 * std::abs(energy));
    EXPECT_EQ(entry.at("contact").at("bottom").at("open"), alone.at("contact").at("bottom").at("open"));
    // The first entry and the last, whose load is another one.
    EXPECT_EQ(entry.at("summary").contains("error_bound"), i == 0 || i + 1 == sweep.size());
    if (!entry.at("summary").contains("error_bound")) continue;
    const double bound = alone.at("summary").at("error_bound").at("value");
    EXPECT_NEAR(entry.at("summary").at("error_bound").at("value").get<double>(), bound, 1e-8 * bound);
  }
}

TEST_F(DaemonTest, ASweepServesWhatItCouldSolve) {
  json problem = example("held-by-contact");
  problem["boundary"] = {{"bottom", {{"type", "contact"}}}};
  problem["sweep"] = {{{"title", "up"}, {"load", {{"body", 1}}}},
                      {{"title", "down"}, {"load", {{"body", -2}}}}};
  const json result = json::parse(post(problem, "?wait=60&fields=sweep")->body);
  EXPECT_EQ(result.at("status"), "failed");
  EXPECT_EQ(result.at("sweep")[0].at("status"), "failed");
  EXPECT_NE(result.at("sweep")[0].at("error").get<std::string>().find("lifts it off"), std::string::npos);
  EXPECT_NEAR(result.at("sweep")[1].at("summary").at("contact").at("force").get<double>(), 2, 1e-10);
  const std::string id = result.at("id");
  const json error = status_of(id).at("error");
  EXPECT_NE(error.at("detail").get<std::string>().find("1 of 2 entries"), std::string::npos);
  EXPECT_EQ(result.value("error", json()), error);
  for (const char* fields : {"", "?fields=sweep", "?fields=summary"}) {
    const json later = json::parse(client_.Get("/v1/solves/" + id + "/result" + fields)->body);
    EXPECT_EQ(later.value("error", json()), error) << fields;
  }
}

TEST_F(DaemonTest, CancelsASweepBetweenItsEntries) {
  json problem = paper_problem(sanitized ? 24 : 96);
  problem["sweep"] = json::array();
  for (int i = 0; i < 5000; ++i) problem["sweep"].push_back({{"load", {{"body", -1 - i}}}});
  const std::string id = submit(problem);
  const auto until = Clock::now() + 60s;
  const auto done = [&] {
    const json progress = status_of(id).at("progress");
    return progress.contains("sweep") ? progress.at("sweep").at("done").get<int>() : 0;
  };
  while (done() < 2 && Clock::now() < until) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(status_of(id).at("progress").at("sweep").at("count"), 5000);
  const auto begin = Clock::now();
  EXPECT_EQ(client_.Delete("/v1/solves/" + id)->status, 202);
  while (status_of(id).at("status") == "running" && Clock::now() < begin + 20s)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(status_of(id).at("status"), "cancelled");
  EXPECT_LT(Clock::now() - begin, soon);
}

/// Each row has the numbers of the problem on its mesh, posted by itself.
TEST_F(DaemonTest, RowsOfAStudyAreSolvesOfTheirOwn) {
  json problem = example("convergence-study");
  const auto reply = client_.Post("/v1/studies?wait=60&fields=study", problem.dump(), "application/json");
  const json result = json::parse(reply->body);
  EXPECT_EQ(result.at("status"), "succeeded");
  const json rows = result.at("study").at("rows");
  ASSERT_EQ(rows.size(), 8u);
  problem.erase("study");
  problem["mesh"]["divisions"] = {8, 4};
  const json alone = json::parse(post(problem, "?wait=60&fields=summary")->body).at("summary");
  EXPECT_EQ(rows[1].at("triangles"), alone.at("triangles"));
  EXPECT_EQ(rows[1].at("energy"), alone.at("energy"));
  EXPECT_EQ(rows[1].at("bound"), alone.at("error_bound").at("value"));
  EXPECT_FALSE(alone.at("reused").get<bool>());
  for (const json& row : rows) {
    EXPECT_GE(row.at("effectivity").get<double>(), 1 - 1e-9);
    EXPECT_LE(row.at("effectivity").get<double>(), 2);
  }

  const auto csv = client_.Get(reply->get_header_value("Location") + "/study.csv");
  ASSERT_EQ(csv->status, 200);
  EXPECT_EQ(csv->get_header_value("Content-Type"), "text/csv; charset=utf-8");
  EXPECT_EQ(std::count(csv->body.begin(), csv->body.end(), '\n'), 9);
}

TEST_F(DaemonTest, AStudyServesWhatItCouldSolve) {
  json problem = example("paper-nonconforming");
  problem["solver"] = {{"max_iterations", 12}};
  problem["mesh"]["divisions"] = {4, 4};
  problem["study"] = {{"divisions", {4, 32}}};
  const json result = json::parse(post(problem, "?wait=60&fields=study")->body);
  EXPECT_EQ(result.at("status"), "failed");
  EXPECT_TRUE(result.at("study").at("rows")[0].contains("bound"));
  EXPECT_TRUE(result.at("study").at("rows")[1].contains("error"));
  const std::string detail = status_of(result.at("id")).at("error").at("detail");
  EXPECT_NE(detail.find("1 of 2 rows"), std::string::npos) << detail;
  EXPECT_NE(detail.find("/study/divisions/1"), std::string::npos) << detail;
}

TEST_F(DaemonTest, CancelsAStudyBetweenItsRuns) {
  json problem = example("convergence-study");
  problem["study"]["divisions"] = json(64, 64);
  const std::string id = submit(problem);
  const auto until = Clock::now() + 60s;
  const auto done = [&] {
    const json progress = status_of(id).at("progress");
    return progress.contains("study") ? progress.at("study").at("done").get<int>() : 0;
  };
  while (done() < 2 && Clock::now() < until) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(status_of(id).at("progress").at("study").at("count"), 128);
  EXPECT_EQ(client_.Delete("/v1/solves/" + id)->status, 202);
  while (status_of(id).at("status") == "running" && Clock::now() < until) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(status_of(id).at("status"), "cancelled");
}

/// Table 6.1 of the paper, iterations 10, 20, …, 70, through HTTP.
TEST_F(DaemonTest, PostedExamplesReproduceTheTableOfThePaper) {
  const std::map<std::string, std::vector<double>> table{
      {"paper-conforming", {0.0391011, 0.0395721, 0.0365382, 0.0315310, 0.0227896, 0.0149436, 0.0094068}},
      {"paper-nonconforming", {0.0667215, 0.0354249, 0.0131121, 0.0047859, 0.0017652, 0.0006545, 0.0002429}}};
  for (const auto& [name, column] : table) {
    const auto reply =
        client_.Post("/v1/solves?wait=60&fields=history", example(name).dump(), "application/json");
    ASSERT_EQ(reply->status, 200);
    const json change = json::parse(reply->body).at("history").at("displacement_change");
    for (std::size_t i = 0; i < column.size(); ++i)
      EXPECT_NEAR(change.at(10 * i + 9).get<double>(), column[i], 0.075 * column[i]) << name << ' ' << i;
  }
}

TEST_F(DaemonTest, SolvesTheProblemOfThePaperOn256Squares) {
  if (sanitized) GTEST_SKIP() << "fewer squares take the same ways";
  const auto reply =
      client_.Post("/v1/solves?wait=100&fields=summary", paper_problem(256).dump(), "application/json");
  ASSERT_EQ(reply->status, 200);
  const json result = json::parse(reply->body);
  EXPECT_EQ(result.at("status"), "succeeded");
  EXPECT_NEAR(result.at("summary").at("energy").get<double>(), -0.914792951, 1e-4);
}

TEST_F(DaemonTest, CancelsALargeSolveWithinASecond) {
  for (const char* phase : {"assemble", "factorize"}) {
    const std::string id = submit(paper_problem(sanitized ? 128 : 768));
    wait_for_phase(id, phase);
    const auto begin = Clock::now();
    EXPECT_EQ(client_.Delete("/v1/solves/" + id)->status, 202);
    json status;
    do {
      std::this_thread::sleep_for(5ms);
      status = status_of(id).at("status");
    } while (status == "running" && Clock::now() - begin < 20s);
    EXPECT_LT(Clock::now() - begin, soon) << phase;
    EXPECT_EQ(status, "cancelled") << phase;
  }
}

/// Reads until the log has the line; the daemon may be busy.
void wait_for_line(Daemon& daemon, const std::string& line) {
  const auto until = Clock::now() + 60s;
  while (daemon.process().standard_error().find(line) == std::string::npos && Clock::now() < until)
    std::this_thread::sleep_for(5ms);
  EXPECT_NE(daemon.process().standard_error().find(line), std::string::npos)
      << daemon.process().standard_error();
}

TEST_F(DaemonTest, DrainsUntilTheRunningSolvesHaveEnded) {
  const std::string id = submit(paper_problem(sanitized ? 96 : 192));
  wait_for_phase(id, "assemble");
  daemon_.process().signal(SIGTERM);
  wait_for_line(daemon_, "draining");
  // Solved meanwhile, on a fast machine; then there is nobody to ask any more.
  const auto ready = client_.Get("/readyz");
  EXPECT_EQ(ready ? ready->status : 503, 503);
  const auto refused = post(paper_problem(4), "");
  EXPECT_EQ(refused ? refused->status : 503, 503);
  EXPECT_EQ(daemon_.process().wait(60s), 0);
  EXPECT_NE(daemon_.process().standard_error().find("converged"), std::string::npos)
      << daemon_.process().standard_error();
}

TEST_F(DaemonTest, ASecondSignalHurriesThoseThatDrain) {
  const std::string id = submit(paper_problem(sanitized ? 256 : 768));
  wait_for_phase(id, "assemble");
  daemon_.process().signal(SIGTERM);
  wait_for_line(daemon_, "draining");
  daemon_.process().signal(SIGTERM);
  EXPECT_EQ(daemon_.process().wait(5 * soon), 0);
  EXPECT_NE(daemon_.process().standard_error().find("cancelled kind=cancelled"), std::string::npos)
      << daemon_.process().standard_error();
}

TEST(Drain, GivesSolvesBackWhenItsTimeIsOver) {
  const TemporaryDirectory directory;
  const std::vector<std::string> flags{"--data-dir", directory.path(), "--drain-seconds", "0"};
  std::string id;
  for (int start = 0; start < 4; ++start) {
    Daemon daemon(flags);
    httplib::Client client("127.0.0.1", daemon.port());
    if (start == 0)
      id = json::parse(client.Post("/v1/solves", paper_problem(768).dump(), "application/json")->body)
               .at("id");
    wait_for_line(daemon, "job=" + id + " started");
    daemon.process().signal(SIGTERM);
    EXPECT_EQ(daemon.process().wait(5 * soon), 0);
    // Not as often as a solve may die: its attempts are not counted against it.
    EXPECT_NE(daemon.process().standard_error().find("job=" + id + " queued again"), std::string::npos)
        << daemon.process().standard_error();
  }
}

TEST(Trace, ReachesTheLinesOfTheJob) {
  Daemon daemon({"--log-format", "json", "--data-dir", ":memory:"});
  httplib::Client client("127.0.0.1", daemon.port());
  const std::string trace = "0af7651916cd43dd8448eb211c80319c";
  client.Post("/v1/solves?wait=60",
              {{"traceparent", "00-" + trace + "-b7ad6b7169203331-01"}, {"X-Request-Id", "r1"}},
              example("paper-nonconforming").dump(), "application/json");
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(5 * soon), 0);
  std::istringstream lines(daemon.process().standard_error());
  std::map<std::string, json> by_message;
  for (std::string line; std::getline(lines, line);) {
    const json object = json::parse(line);
    by_message.emplace(object.at("message"), object);
  }
  const std::string job = by_message.at("started").at("job");
  EXPECT_EQ(by_message.at("started").at("trace"), trace);
  EXPECT_EQ(by_message.at("converged").at("trace"), trace);
  EXPECT_EQ(by_message.at("converged").at("iterations"), 103);
  EXPECT_EQ(by_message.at("answered").at("trace"), trace);
  EXPECT_EQ(by_message.at("answered").at("request"), "r1");
  EXPECT_EQ(by_message.at("answered").at("job"), job);
}

TEST(HealthCommand, SaysWhetherTheServiceLives) {
  Daemon daemon;
  const std::string port = std::to_string(daemon.port());
  ChildProcess well({"--host", "0.0.0.0", "--port", port, "health"});
  EXPECT_EQ(well.wait(60s), 0) << well.standard_error();
  daemon.process().signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(5 * soon), 0);
  ChildProcess ill({"health", "--port", port});
  EXPECT_EQ(ill.wait(60s), 1);
  EXPECT_NE(ill.standard_error().find("no service answers"), std::string::npos);
}

TEST_F(DaemonTest, StopsCleanlyOnCtrlC) {
  daemon_.process().signal(SIGINT);
  EXPECT_EQ(daemon_.process().wait(2 * soon), 0);
}

TEST_F(DaemonTest, LogsFromTheRequestToTheSolve) {
  const auto reply = client_.Post("/v1/solves?wait=60", {{"X-Request-Id", "trace-17"}},
                                  example("paper-nonconforming").dump(), "application/json");
  const std::string id = json::parse(reply->body).at("id");
  const std::string log = daemon_.process().standard_error();
  for (const std::string& line :
       {"job=" + id + " started", "job=" + id + " seconds=",
        std::string("request=trace-17 method=POST path=/v1/solves?wait=60 status=200 job=") + id}) {
    EXPECT_NE(log.find(line), std::string::npos) << line << '\n' << log;
  }
}

TEST(DaemonFlags, ThatCannotBeMetEndItWithExitCode2) {
  Daemon first;
  ChildProcess second({"--data-dir", ":memory:", "--port", std::to_string(first.port())});
  EXPECT_EQ(second.wait(60s), 2);
  EXPECT_NE(second.standard_error().find("cannot listen"), std::string::npos);

  const TemporaryDirectory directory;
  Daemon owner({"--data-dir", directory.path()});
  ChildProcess intruder({"--data-dir", directory.path(), "--port", "0"});
  EXPECT_EQ(intruder.wait(60s), 2);
  EXPECT_NE(intruder.standard_error().find("another service"), std::string::npos);
}

TEST(SolveCommand, WritesTheResult) {
  ChildProcess process({"solve", "-"}, example("paper-nonconforming").dump());
  EXPECT_EQ(process.wait(60s), 0) << process.standard_error();
  const json result = json::parse(process.standard_output());
  EXPECT_FALSE(result.contains("id"));
  EXPECT_EQ(result.at("summary").at("outcome"), "converged");
  EXPECT_EQ(process.standard_error(), "");
}

TEST(SolveCommand, PicksFields) {
  ChildProcess process({"solve", "--fields", "summary", "-"}, example("paper-nonconforming").dump());
  EXPECT_EQ(process.wait(60s), 0) << process.standard_error();
  EXPECT_FALSE(json::parse(process.standard_output()).contains("mesh"));
}

TEST(SolveCommand, WritesTheResultForParaView) {
  ChildProcess process({"solve", "--format", "vtu", "-"}, example("paper-nonconforming").dump());
  EXPECT_EQ(process.wait(60s), 0) << process.standard_error();
  EXPECT_NE(process.standard_output().find("<Piece NumberOfPoints=\"960\" NumberOfCells=\"336\">"),
            std::string::npos);
  EXPECT_TRUE(process.standard_output().ends_with("</VTKFile>\n"));
}

TEST(SolveCommand, DrawsAPicture) {
  ChildProcess process({"solve", "--format", "svg", "--field", "von_mises", "--deformed", "2", "-"},
                       example("elastic-block").dump());
  EXPECT_EQ(process.wait(60s), 0) << process.standard_error();
  EXPECT_TRUE(process.standard_output().starts_with("<svg "));
  EXPECT_TRUE(process.standard_output().ends_with("</svg>\n"));
}

/// The same energy, and more memory than the other took.
void expect_other_factor(const json& summary, const json& other) {
  const double energy = other.at("energy");
  EXPECT_NEAR(summary.at("energy").get<double>(), energy, 1e-10 * std::abs(energy));
  if (sanitized) return;  // a sanitizer has an allocator of its own
  const double ratio =
      summary.at("peak_memory_bytes").get<double>() / other.at("peak_memory_bytes").get<double>();
  EXPECT_GT(ratio, 1.1);
}

TEST(SolveCommand, FactorsAsItIsAskedTo) {
  const auto summary = [](std::vector<std::string> flags, const std::vector<std::string>& launcher = {}) {
    flags.insert(flags.begin(), {"solve", "--fields", "summary"});
    flags.push_back("-");
    ChildProcess process(flags, paper_problem(64).dump(), launcher);
    EXPECT_EQ(process.wait(60s), 0) << process.standard_error();
    return json::parse(process.standard_output()).at("summary");
  };
  const json ours = summary({});
  expect_other_factor(summary({"--factorization", "cholmod"}), ours);
  const std::vector<std::string> launcher{"env", "SIGNORINI_FACTORIZATION=cholmod"};
  expect_other_factor(summary({}, launcher), ours);
  expect_other_factor(summary({}, launcher), summary({"--factorization", "multifrontal"}, launcher));
}

TEST_F(DaemonTest, FactorsAsItIsAskedTo) {
  Daemon other({"--factorization", "cholmod"});
  httplib::Client client("127.0.0.1", other.port());
  client.set_read_timeout(100);
  const std::string problem = paper_problem(64).dump();
  const auto solved = [&](httplib::Client& by) {
    const json result =
        json::parse(by.Post("/v1/solves?wait=60&fields=summary", problem, "application/json")->body);
    EXPECT_EQ(result.at("status"), "succeeded");
    return result.at("summary");
  };
  const auto predicted = [&](httplib::Client& by) {
    const json estimated =
        json::parse(by.Post("/v1/validate", problem, "application/json")->body).at("estimated");
    return estimated.at("memory_bytes").get<double>();
  };
  const json ours = solved(client_), cholmods = solved(client);
  expect_other_factor(cholmods, ours);
  EXPECT_GT(predicted(client), predicted(client_));
  EXPECT_GE(predicted(client), cholmods.at("peak_memory_bytes").get<double>());
}

TEST(SolveCommand, AnIterationThatDoesNotEndIsServedWithExitCode1) {
  json problem = example("paper-nonconforming");
  problem["solver"]["max_iterations"] = 3;
  ChildProcess process({"solve", "-"}, problem.dump());
  EXPECT_EQ(process.wait(60s), 1);
  EXPECT_EQ(json::parse(process.standard_output()).at("summary").at("outcome"), "iteration_limit");
  EXPECT_NE(json::parse(process.standard_error()).at("detail"), "");
}

TEST(SolveCommand, ABodyThatNothingHoldsHasExitCode1) {
  json problem = example("paper-nonconforming");
  problem["boundary"] = {{"bottom", {{"type", "contact"}}}};
  problem["load"]["body"] = 1;
  problem.erase("solver");
  ChildProcess up({"solve", "-"}, problem.dump());
  problem["load"]["body"] = -1;
  ChildProcess down({"solve", "-"}, problem.dump());
  // The contact holds the body in one direction only.
  const int codes = up.wait(60s).value_or(-1) + down.wait(60s).value_or(-1);
  EXPECT_EQ(codes, 1) << up.standard_error() << down.standard_error();
}

TEST(SolveCommand, BadInputHasExitCode2) {
  for (const char* text : {"", "{", "{\"model\": \"membrane\"}"}) {
    ChildProcess process({"solve", "-"}, text);
    EXPECT_EQ(process.wait(60s), 2) << text;
    EXPECT_TRUE(json::parse(process.standard_error()).contains("title")) << text;
    EXPECT_EQ(process.standard_output(), "");
  }
  for (const char* file : {"/nonexistent.json", "/tmp"})
    for (const char* command : {"solve", "study"}) {
      ChildProcess unreadable({command, file});
      EXPECT_EQ(unreadable.wait(60s), 2) << file;
      EXPECT_EQ(json::parse(unreadable.standard_error()).at("title"), "The file cannot be read");
    }
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--fields", "everything"},
                                             {"--fields", "von_mises"},  // of a membrane
                                             {"--format", "vtk"},
                                             {"--format", "vtu", "--fields", "mesh"},
                                             {"--format", "svg", "--field", "strain"},
                                             {"--format", "svg", "--deformed", "2"},  // of a membrane
                                             {"--format", "svg", "--deformed", "nan"},
                                             {"--field", "stress"}}) {
    std::vector<std::string> arguments{"solve", "-"};
    arguments.insert(arguments.begin() + 1, flags.begin(), flags.end());
    ChildProcess process(arguments, example("paper-nonconforming").dump());
    EXPECT_EQ(process.wait(60s), 2) << flags.back();
    EXPECT_EQ(process.standard_output(), "");
  }
}

/// Between the points of a coarse mesh, at which a problem is looked at when it is sent.
TEST_F(DaemonTest, AFaultThatTheSolveFindsHasTheStatusOfARefusal) {
  json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {32, 32};
  problem["load"]["body"] = "log((x-0.4123)^2+(y-0.3331)^2-1e-4)";
  const json status = json::parse(post(problem, "?wait=60")->body);
  EXPECT_EQ(status.at("status"), "failed");
  EXPECT_EQ(status.at("error").at("status"), 422);
  ChildProcess process({"solve", "-"}, problem.dump());
  EXPECT_EQ(process.wait(60s), 2);
  EXPECT_EQ(json::parse(process.standard_error()).at("status"), 422);
}

TEST(StudyCommand, WritesItsTableInEveryFormat) {
  const std::string problem = example("convergence-study").dump();
  ChildProcess table({"study", "-"}, problem);
  EXPECT_EQ(table.wait(60s), 0) << table.standard_error();
  for (const char* text : {"conforming\n\n", "nonconforming\n\n", "triangles", "bound_rate", "fitted"})
    EXPECT_NE(table.standard_output().find(text), std::string::npos) << text;
  ChildProcess csv({"study", "--format", "csv", "-"}, problem);
  EXPECT_EQ(csv.wait(60s), 0) << csv.standard_error();
  EXPECT_TRUE(csv.standard_output().starts_with("scheme,size,triangles,unknowns,bound,bound_rate,"));
  ChildProcess document({"study", "--format", "json", "-"}, problem);
  EXPECT_EQ(document.wait(60s), 0) << document.standard_error();
  EXPECT_EQ(json::parse(document.standard_output()).at("study").at("rows").size(), 8u);
}

TEST(StudyCommand, NeedsAStudy) {
  ChildProcess process({"study", "-"}, example("paper-nonconforming").dump());
  EXPECT_EQ(process.wait(60s), 2);
  EXPECT_NE(process.standard_error().find("no-study"), std::string::npos);
  EXPECT_EQ(process.standard_output(), "");
}

/// The constants are those of solver/README.md.
TEST(InfSupCommand, TellsTheConstantOfTheProblemsOwnMeshAndScheme) {
  json problem = paper_problem(4);
  for (const auto& [scheme, constant] :
       std::vector<std::pair<std::string, double>>{{"conforming", 0.9318}, {"nonconforming", 0.9243}}) {
    problem["scheme"] = scheme;
    ChildProcess document({"inf-sup", "--format", "json", "-"}, problem.dump());
    EXPECT_EQ(document.wait(60s), 0) << document.standard_error();
    const json found = json::parse(document.standard_output());
    EXPECT_NEAR(found.at("inf_sup").get<double>(), constant, 5e-5);
    EXPECT_EQ(found.at("scheme"), scheme);
    EXPECT_EQ(found.at("triangles"), 32);
    EXPECT_EQ(found.at("unknowns").at("stress"), scheme == "conforming" ? 176 : 56);
    ChildProcess table({"inf-sup", "-"}, problem.dump());
    EXPECT_EQ(table.wait(60s), 0) << table.standard_error();
    EXPECT_TRUE(
        table.standard_output().starts_with("inf-sup constant  " + std::to_string(constant).substr(0, 5)))
        << table.standard_output();
  }
}

TEST(InfSupCommand, RefusesWhatHasNoSuchConstant) {
  json adaptive = paper_problem(4), fine = paper_problem(400), misspelt = paper_problem(4);
  adaptive["mesh"]["adaptive"] = {{"tolerance", 0.1}};
  adaptive["solver"] = {{"method", "active_set"}};
  misspelt["sheme"] = "conforming";
  for (const auto& [problem, pointer] : std::vector<std::pair<json, std::string>>{
           {adaptive, "/mesh/adaptive"}, {fine, "/mesh"}, {misspelt, "/sheme"}}) {
    ChildProcess process({"inf-sup", "-"}, problem.dump());
    EXPECT_EQ(process.wait(60s), 2) << pointer;
    EXPECT_EQ(process.standard_output(), "");
    EXPECT_EQ(json::parse(process.standard_error()).at("errors").at(0).at("pointer"), pointer);
  }
}

TEST(InfSupCommand, EndsWhereItsTimeIsUp) {
  json problem = paper_problem(150);
  problem["solver"]["time_limit"] = 0.05;
  ChildProcess process({"inf-sup", "-"}, problem.dump());
  EXPECT_EQ(process.wait(10 * soon), 1);
  EXPECT_NE(process.standard_error().find("time limit"), std::string::npos) << process.standard_error();
}

TEST(SolveCommand, EndsOnCtrlC) {
  ChildProcess process({"solve", "-"}, paper_problem(1024).dump());
  std::this_thread::sleep_for(sanitized ? 3s : 500ms);  // a sanitized program takes half a second to begin
  process.signal(SIGINT);
  EXPECT_EQ(process.wait(10 * soon), 1);
  EXPECT_EQ(json::parse(process.standard_error()).at("title"), "The solve was cancelled");
}

}  // namespace
}  // namespace signorini::server::daemon_test
