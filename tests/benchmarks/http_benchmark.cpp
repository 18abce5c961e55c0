/// What a small problem costs through HTTP: a child service with two workers on the loopback, keep-alive
/// clients that post and wait for the summary. The clients run on the same cores as the service. Not covered:
/// a real network, TLS.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "api/examples.hpp"
#include "child_process.hpp"

namespace signorini::server {
namespace {

using nlohmann::json;

std::string paper_problem(const json& solver) {
  const auto& all = api::examples();
  const auto paper = std::find_if(all.begin(), all.end(),
                                  [](const api::Example& e) { return e.name == "paper-nonconforming"; });
  json problem = json::parse(paper->json);
  problem["solver"] = solver;
  return problem.dump();
}

std::string active_set() {
  return paper_problem({{"method", "active_set"}});
}

/// The paper's iteration, 200 of it: the tolerance is never met.
std::string uzawa_200() {
  return paper_problem({{"method", "uzawa"},
                        {"rho", 0.1},
                        {"augmentation", 1},
                        {"initial_displacement", 0.5},
                        {"tolerance", 1e-300},
                        {"max_iterations", 200}});
}

class Client {
 public:
  explicit Client(int port) : client_("127.0.0.1", port) {
    client_.set_keep_alive(true);
    client_.set_tcp_nodelay(true);
  }

  void solve(const std::string& problem) {
    const auto reply = client_.Post("/v1/solves?wait=60&fields=summary", problem, "application/json");
    if (!reply || reply->status != 200) throw std::runtime_error("no result");
  }

 private:
  httplib::Client client_;
};

Daemon& service() {
  static Daemon daemon({"--workers", "2", "--data-dir", ":memory:"});
  return daemon;
}

/// On the disk that it was built on; a temporary directory may lie in memory.
Daemon& durable_service() {
  static const std::string directory = std::filesystem::path(SIGNORINID).replace_filename("benchmark-data");
  std::filesystem::remove_all(directory);
  static Daemon daemon({"--workers", "2", "--data-dir", directory, "--queue-limit", "1000"});
  return daemon;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One client; `median_ms` is the time from the request to the whole reply.
void HttpLatency(benchmark::State& state, const std::string& problem) {
  using Milliseconds = std::chrono::duration<double, std::milli>;
  Client client(service().port());
  client.solve(problem);
  std::vector<double> times;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    client.solve(problem);
    times.push_back(Milliseconds(std::chrono::steady_clock::now() - begin).count());
  }
  state.counters["median_ms"] = median(times);
}

/// So many clients at once, 1600 solves together.
void HttpThroughput(benchmark::State& state, Daemon& (*daemon)(), int clients, const std::string& problem) {
  const int solves_each = 1600 / clients, port = daemon().port();
  for (auto _ : state) {
    std::vector<std::jthread> threads;
    for (int i = 0; i < clients; ++i)
      threads.emplace_back([&] {
        Client client(port);
        for (int k = 0; k < solves_each; ++k) client.solve(problem);
      });
  }
  state.counters["solves_per_second"] =
      benchmark::Counter(clients * solves_each, benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(HttpLatency, active_set, active_set())->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(HttpLatency, uzawa_200_iterations, uzawa_200())
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(HttpThroughput, active_set, service, 8, active_set())
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(HttpThroughput, active_set_64_clients, service, 64, active_set())
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(HttpThroughput, active_set_64_clients_on_disk, durable_service, 64, active_set())
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace signorini::server
