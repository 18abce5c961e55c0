// As many guests at once as may be: streams of events, clients that wait for a solve, and idle connections.

#include "running_service.hpp"

#include <algorithm>
#include <thread>

#include <sys/resource.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "child_process.hpp"
#include "process_figures.hpp"
#include "raw_client.hpp"

namespace signorini::server::crowd_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

/// Of this process, whose limit it raises as far as it may.
std::size_t descriptors_allowed() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}

struct Crowd {
  std::size_t streams, waiters, idle;
  std::size_t all() const { return streams + waiters + idle; }
};

Crowd crowd_for_test() {
  return long_tests() && !sanitized ? Crowd{10'000, 1000, 4096} : Crowd{600, 100, 300};
}

/// A problem that a worker has for minutes.
std::string long_problem() {
  json problem = json::parse(problem_titled("long"));
  problem["mesh"]["divisions"] = {200, 200};
  problem["solver"] = {{"method", "uzawa"},
                       {"rho", 1e-6},
                       {"augmentation", 1},
                       {"tolerance", 1e-300},
                       {"max_iterations", 1'000'000}};
  return problem.dump();
}

httplib::Client patient_client(int port) {
  httplib::Client client("127.0.0.1", port);
  client.set_read_timeout(60);
  client.set_keep_alive(true);
  client.set_tcp_nodelay(true);
  return client;
}

TEST(Crowd, OfEveryKindLeavesTheServiceToOthers) {
  const Crowd crowd = crowd_for_test();
  // From one address to one port there are some 28 000 connections.
  const std::size_t needed = crowd.all() + 200;
  if (descriptors_allowed() < needed)
    GTEST_SKIP() << "this machine allows " << descriptors_allowed() << " descriptors a process (ulimit -n), "
                 << needed << " are needed";
  Daemon daemon({"--workers", "1", "--max-subscribers", std::to_string(crowd.streams)});
  httplib::Client client = patient_client(daemon.port());
  const std::string body = long_problem();
  const auto accepted = client.Post("/v1/solves", {{"Idempotency-Key", "one"}}, body, "application/json");
  ASSERT_EQ(accepted->status, 202) << accepted->body;
  const std::string path = "/v1/solves/" + std::string(json::parse(accepted->body).at("id"));
  // What the solve itself takes is taken by then.
  while (json::parse(client.Get(path)->body).at("progress").at("iteration") == 0)
    std::this_thread::sleep_for(10ms);
  const std::size_t before = figures_of(daemon.process().id()).memory;

  std::vector<RawClient> streams, others;
  const auto admitted = [&](std::vector<RawClient>& guests) {
    return listen_until(guests, 120s, [&] {
      return std::ranges::all_of(guests, [](const RawClient& guest) { return guest.status() == 200; });
    });
  };
  for (std::size_t i = 0; i < crowd.streams; ++i) {
    streams.emplace_back(daemon.port());
    streams.back().send("GET " + path + "/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    if (streams.size() % 500 == 0) {
      EXPECT_TRUE(admitted(streams)) << i;
    }
  }
  EXPECT_TRUE(admitted(streams));
  const std::string waits =
      "POST /v1/solves?wait=3600 HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
      "Idempotency-Key: one\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body;
  for (std::size_t i = 0; i < crowd.waiters; ++i) {
    others.emplace_back(daemon.port());
    others.back().send(waits);
  }
  for (std::size_t i = 0; i < crowd.idle; ++i) others.emplace_back(daemon.port());

  // The connection of the first client idled, and may have given way to those who came.
  httplib::Client asker = patient_client(daemon.port());
  std::vector<double> milliseconds;
  for (int i = 0; i < (long_tests() ? 2000 : 300); ++i) {
    const auto begin = Clock::now();
    const auto reply = asker.Get(path);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    ASSERT_TRUE(reply) << i << ": " << httplib::to_string(reply.error());
    ASSERT_EQ(reply->status, 200);
    if (i % 20 == 0)
      for (RawClient& stream : streams) stream.receive();
  }
  std::ranges::sort(milliseconds);
  const double p99 = milliseconds[milliseconds.size() * 99 / 100];
  const std::size_t memory = figures_of(daemon.process().id()).memory;
  const auto each = static_cast<double>(memory - std::min(memory, before)) / static_cast<double>(crowd.all());
  RecordProperty("p99_ms", std::to_string(p99));
  RecordProperty("bytes_a_guest", std::to_string(each));
  if (!sanitized) {
    // The short form is for machines that have other things to do as well.
    EXPECT_LT(p99, long_tests() ? 50 : 200);
    EXPECT_LT(each, 16 * 1024);
  }
  EXPECT_TRUE(std::ranges::none_of(streams, &RawClient::closed));
}

}  // namespace
}  // namespace signorini::server::crowd_test
