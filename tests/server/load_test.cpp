// Many clients at once, and many jobs one after another.

#include "running_service.hpp"

#include <array>
#include <atomic>
#include <cstdio>
#include <regex>
#include <thread>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "example_problems.hpp"
#include "process_figures.hpp"

namespace signorini::server::load_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> piece;
  while (std::fgets(piece.data(), piece.size(), pipe) != nullptr) output += piece.data();
  ::pclose(pipe);
  return output;
}

/// Milliseconds of the line `99%  12.34ms` of wrk.
double p99_of(const std::string& output) {
  std::smatch found;
  if (!std::regex_search(output, found, std::regex(R"(99%\s+([0-9.]+)(us|ms|s))"))) return -1;
  const double unit = found[2] == "us" ? 1e-3 : found[2] == "ms" ? 1 : 1e3;
  return std::stod(found[1]) * unit;
}

/// Keeps both workers busy.
class Busy {
 public:
  explicit Busy(int port) : thread_([this, port] { run(port); }) {}
  ~Busy() {
    stopping_ = true;
    thread_.join();
  }

 private:
  void run(int port) {
    httplib::Client client("127.0.0.1", port);
    const std::string problem = paper_problem(200).dump();
    while (!stopping_) {
      const auto waiting = client.Get("/v1/solves?status=queued");
      if (!waiting) continue;
      if (json::parse(waiting->body).at("solves").size() < 4) {
        client.Post("/v1/solves", problem, "application/json");
      } else {
        std::this_thread::sleep_for(20ms);
      }
    }
  }

  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

TEST(Load, OfTwoHundredConnectionsWhileBothWorkersSolve) {
  Daemon daemon({"--workers", "2", "--cache-bytes", "0"});
  httplib::Client client("127.0.0.1", daemon.port());
  const auto solved =
      client.Post("/v1/solves?wait=100&fields=summary", paper_problem(12).dump(), "application/json");
  ASSERT_EQ(solved->status, 200);
  const std::string url = "http://127.0.0.1:" + std::to_string(daemon.port()) + "/v1/solves/" +
                          std::string(json::parse(solved->body).at("id"));
  const Busy busy(daemon.port());
  const std::string output =
      output_of("wrk -t1 -c200 -d" + std::string(long_tests() ? "30" : "4") + "s --latency " + url + " 2>&1");
  RecordProperty("p99_ms", std::to_string(p99_of(output)));
  EXPECT_NE(output.find("Requests/sec"), std::string::npos) << output;
  EXPECT_EQ(output.find("Non-2xx"), std::string::npos) << output;
  EXPECT_EQ(output.find("Socket errors"), std::string::npos) << output;
  // The short form is for machines that have other things to do as well.
  if (!sanitized) {
    EXPECT_LT(p99_of(output), long_tests() ? 50 : 200) << output;
  }
  if (long_tests()) std::puts(output.c_str());
}

/// As soon as it is warm, a service that solves small jobs one after another grows no more.
TEST(Soak, LeavesNothingBehind) {
  const int jobs = long_tests() ? 20'000 : 500;
  Daemon daemon({"--keep-bytes", "1mb"});
  const std::string problem = paper_problem(4).dump();
  const auto solve = [&](int count) {
    httplib::Client client("127.0.0.1", daemon.port());
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
    for (int i = 0; i < count; ++i) {
      const auto reply = client.Post("/v1/solves?wait=60&fields=summary", problem, "application/json");
      ASSERT_TRUE(reply) << i;
      ASSERT_EQ(reply->status, 200) << i << reply->body;
    }
  };
  solve(jobs / 4);
  const ProcessFigures warm = figures_of(daemon.process().id());
  solve(jobs);
  const ProcessFigures end = figures_of(daemon.process().id());
  RecordProperty("warm_mb", static_cast<int>(warm.memory >> 20));
  RecordProperty("end_mb", static_cast<int>(end.memory >> 20));
  EXPECT_EQ(end.threads, warm.threads);
  EXPECT_LE(end.descriptors, warm.descriptors + 2);
  if (!sanitized) {
    EXPECT_LE(end.memory, warm.memory + (std::size_t{8} << 20));
  }
}

}  // namespace
}  // namespace signorini::server::load_test
