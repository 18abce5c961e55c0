// Clients that mean harm: the service keeps its memory, and answers everybody else.

#include "running_service.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <functional>
#include <thread>

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "../problems/json_problems.hpp"
#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "api/document/gzip.hpp"
#include "child_process.hpp"
#include "example_problems.hpp"
#include "process_figures.hpp"
#include "raw_client.hpp"

namespace signorini::server::hostile_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;
using problems::membrane_on;
using problems::ring;

constexpr std::size_t body_limit = 4 * megabyte;

std::string post_head(const std::string& headers) {
  return "POST /v1/solves HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" + headers +
         "\r\n\r\n";
}

/// Asks for the same again and again, as a probe does, and keeps the longest time.
class Probe {
 public:
  Probe(int port, const std::string& path) : thread_([this, port, path] { run(port, path); }) {}
  ~Probe() { stop(); }

  std::chrono::milliseconds longest() {
    stop();
    return std::chrono::duration_cast<std::chrono::milliseconds>(longest_);
  }

 private:
  void run(int port, const std::string& path) {
    while (!stopping_) {
      const auto begin = Clock::now();
      httplib::Client client("127.0.0.1", port);
      const auto reply = client.Get(path);
      if (!reply || reply->status != 200) {
        ADD_FAILURE() << path << " is not answered";
        return;
      }
      longest_ = std::max(longest_, Clock::now() - begin);
      std::this_thread::sleep_for(10ms);
    }
  }

  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::atomic<bool> stopping_ = false;
  Clock::duration longest_{};
  std::thread thread_;
};

class Hostile : public testing::Test {
 protected:
  Hostile() : daemon_({"--max-body-bytes", std::to_string(body_limit)}) {}

  int port() const { return daemon_.port(); }

  /// What a client hears that sends this.
  std::string say(const std::string& bytes) {
    std::vector<RawClient> client;
    client.emplace_back(port());
    client[0].send(bytes);
    listen_until(client, 60s, [&] { return client[0].closed(); });
    return client[0].heard();
  }

  /// Memory stays within bounds, those of a body and 32 MB if not told otherwise, and everybody else is
  /// answered: probes of health within 100 ms, a list of solves within a second. What stalls the service
  /// stalls it each time; a pause of the machine, which other programs share, does not come back three times.
  void withstand(const std::function<void()>& attack, std::size_t most = body_limit + 32 * megabyte) {
    httplib::Client("127.0.0.1", port()).Get("/healthz");
    const pid_t process = daemon_.process().id();
    forget_peak(process);
    const std::size_t before = figures_of(process).memory;
    auto health = std::chrono::milliseconds::max(), list = health;
    const bool had_failure = HasFailure();
    for (int attempt = 0; attempt < 3 && (health >= 100ms || list >= 1s) && HasFailure() == had_failure;
         ++attempt) {
      Probe health_probe(port(), "/healthz"), list_probe(port(), "/v1/solves");
      attack();
      health = std::min(health, health_probe.longest());
      list = std::min(list, list_probe.longest());
    }
    const std::size_t peak = figures_of(process).peak_memory;
    RecordProperty("healthz_ms", static_cast<int>(health.count()));
    RecordProperty("list_ms", static_cast<int>(list.count()));
    RecordProperty("memory_mb", static_cast<int>((peak - std::min(peak, before)) / megabyte));
    if (sanitized) return;  // which count memory and time of their own
    EXPECT_LE(peak, before + most);
    EXPECT_LT(health, 100ms);
    EXPECT_LT(list, 1s);
  }

  /// Clients who say this once, and then the second text a byte each second.
  void drip(int count, const std::string& at_once, const std::string& slowly, std::chrono::seconds time) {
    std::vector<RawClient> clients;
    for (int i = 0; i < count; ++i) clients.emplace_back(port());
    for (const RawClient& client : clients) client.send(at_once);
    const auto until = Clock::now() + time;
    for (std::size_t i = 0; Clock::now() < until; ++i) {
      for (const RawClient& client : clients) client.send(std::string(1, slowly[i % slowly.size()]));
      listen_until(clients, 1s, [] { return false; });
    }
  }

  std::chrono::seconds drip_time() const { return long_tests() ? 30s : 3s; }

  Daemon daemon_;
};

TEST_F(Hostile, ChunksBeyondTheLimit) {
  withstand([&] {
    std::vector<RawClient> client;
    client.emplace_back(port());
    client[0].send(post_head("Transfer-Encoding: chunked"));
    const std::string chunk = "10000\r\n" + std::string(0x10000, ' ') + "\r\n";
    std::size_t sent = 0;
    while (sent < 200 * megabyte && client[0].status() == 0 && client[0].send(chunk)) {
      sent += chunk.size();
      client[0].receive();
    }
    listen_until(client, 60s, [&] { return client[0].status() != 0; });
    EXPECT_EQ(client[0].status(), 413) << client[0].heard();
    EXPECT_LT(sent, 100 * megabyte);
  });
}

TEST_F(Hostile, ABodyThatInflates) {
  std::string bomb;
  const api::Sink append = [&](std::string_view piece) {
    bomb += piece;
    return true;
  };
  api::Gzip gzip(append);
  const std::string blank(megabyte, ' ');
  for (int i = 0; i < 300; ++i) gzip.put(blank);
  gzip.finish();
  EXPECT_LT(bomb.size(), 2 * megabyte);
  withstand([&] {
    for (int i = 0; i < 5; ++i) {
      const std::string reply =
          say(post_head("Connection: close\r\nContent-Encoding: gzip\r\nContent-Length: " +
                        std::to_string(bomb.size())) +
              bomb);
      EXPECT_TRUE(reply.starts_with("HTTP/1.1 413 ")) << reply;
    }
  });
}

TEST_F(Hostile, CountlessHeaders) {
  withstand([&] {
    std::string head = "GET /healthz HTTP/1.1\r\n";
    for (int i = 0; i < 200'000; ++i) head += "X-" + std::to_string(i) + ": y\r\n";
    for (int i = 0; i < 5; ++i) EXPECT_EQ(say(head + "\r\n").find(" 200 "), std::string::npos);
  });
}

TEST_F(Hostile, CountlessRanges) {
  httplib::Client client("127.0.0.1", port());
  const auto solved =
      client.Post("/v1/solves?wait=100", example("paper-nonconforming").dump(), "application/json");
  ASSERT_EQ(solved->status, 200);
  const std::string path = "/v1/solves/" + std::string(json::parse(solved->body).at("id")) + "/result";
  withstand([&] {
    std::string ranges = "bytes=0-";
    for (int i = 1; i < 700; ++i) ranges += "," + std::to_string(i) + "-";
    const auto reply = client.Get(path, {{"Range", ranges}});
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->status, 200);
    EXPECT_LE(reply->body.size(), 2 * solved->body.size());
  });
}

TEST_F(Hostile, BrotliForALargeReply) {
  httplib::Client client("127.0.0.1", port());
  client.set_read_timeout(60);
  json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {160, 160};
  problem["solver"] = {{"method", "active_set"}};
  const auto solved = client.Post("/v1/solves?wait=100&fields=summary", problem.dump(), "application/json");
  ASSERT_EQ(solved->status, 200) << solved->body;
  const std::string path = "/v1/solves/" + std::string(json::parse(solved->body).at("id")) + "/result";
  withstand([&] {
    const auto begin = Clock::now();
    const auto reply = client.Get(path, {{"Accept-Encoding", "br"}});
    ASSERT_TRUE(reply);
    EXPECT_FALSE(reply->has_header("Content-Encoding"));
    EXPECT_GT(reply->body.size(), megabyte);
    if (!sanitized) {
      EXPECT_LT(Clock::now() - begin, 2s);
    }
  });
}

TEST_F(Hostile, JsonThatBreaksItsReaders) {
  const auto valued = [](const std::string& value) {
    return "{\"model\": \"membrane\", \"load\": {\"body\": " + value + "}}";
  };
  const std::vector<std::pair<std::string, int>> bodies{
      {std::string(100'000, '['), 400},
      {"{\"model\": " + std::string(100'000, '[') + std::string(100'000, ']') + "}", 400},
      {"{\"title\": \"a\", \"title\": \"b\"}", 400},
      {valued("NaN"), 400},
      {valued("Infinity"), 400},
      {valued("1e999"), 400},
      {"{\"solver\": {\"max_iterations\": 123456789012345678901234567890}}", 422},
      {"\"\xff\xfe\"", 400}};
  withstand([&] {
    for (const auto& [body, status] : bodies) {
      const std::string reply =
          say(post_head("Connection: close\r\nContent-Length: " + std::to_string(body.size())) + body);
      EXPECT_TRUE(reply.starts_with("HTTP/1.1 " + std::to_string(status) + " "))
          << body.substr(0, 60) << reply;
    }
  });
}

json many_holes() {
  json holes = json::array();
  for (int i = 0; i < 16'000; ++i) holes.push_back(ring(4, 0.2, i % 127, i / 127));
  const json outside{{-1, -1}, {128, -1}, {128, 128}, {-1, 128}};
  return membrane_on({{"type", "polygon"}, {"vertices", outside}, {"holes", holes}}, {{"size", 30}});
}

json zigzag(int vertices) {
  json points{{vertices * 1e-3, -1}, {0, -1}};
  for (int i = 0; i < vertices; ++i) points.push_back({i * 1e-3, i % 2});
  return membrane_on({{"type", "polygon"}, {"vertices", points}}, {{"size", 1}});
}

json sweep_of_long_gaps() {
  std::string gap = "0.1";
  while (gap.size() < 390) gap += "+sin(7*x)";
  json problem = membrane_on({{"type", "rectangle"}}, {{"divisions", {8, 8}}});
  problem["boundary"]["bottom"] = {{"type", "contact"}};
  for (int i = 0; i < 9'000; ++i) problem["sweep"].push_back({{"boundary", {{"bottom", {{"gap", gap}}}}}});
  return problem;
}

json sweep_of_many_parts() {
  json problem = membrane_on({{"type", "polygon"}, {"vertices", ring(2000, 1, 0, 0)}}, {{"size", 1}});
  problem["sweep"] = json(10'000, json::object());
  return problem;
}

json unknown_members() {
  json problem = membrane_on({{"type", "rectangle"}}, {{"divisions", {8, 8}}});
  for (int i = 0; i < 250'000; ++i) problem["u" + std::to_string(i)] = 1;
  return problem;
}

json refined_often() {
  json problem = membrane_on({{"type", "mesh"},
                              {"points", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}},
                              {"triangles", {{0, 1, 2}, {0, 2, 3}}},
                              {"boundary", {{"rim", {{0, 1}, {1, 2}, {2, 3}, {3, 0}}}}}},
                             {{"refine", 11}});
  return problem;
}

/// All at once ask what the problem would take, and wait for the answer. Few threads ask for many: hundreds
/// of them would keep the service from the cores, and the probes with it.
void ask_about(const json& problem, int clients, int port) {
  const std::string body = problem.dump();
  ASSERT_LT(body.size(), body_limit);
  const std::string request =
      "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body;
  constexpr int asking = 8;
  std::vector<std::thread> threads;
  for (int i = 0; i < asking; ++i)
    threads.emplace_back([&] {
      std::vector<RawClient> own;
      for (int k = 0; k < clients / asking; ++k) {
        own.emplace_back(port);
        own.back().send(request);
      }
      EXPECT_TRUE(listen_until(own, 60s, [&] {
        return std::ranges::all_of(own, [](const RawClient& client) { return client.status() != 0; });
      })) << body.substr(0, 100);
    });
  for (std::thread& thread : threads) thread.join();
}

/// Nobody makes the mesh for those who ask: each takes 16 MB at most.
TEST_F(Hostile, ProblemsThatAreCostlyToLookAt) {
  const json polygon{{"type", "polygon"}, {"vertices", ring(100, 1, 0, 0)}};
  const std::vector<json> problems{membrane_on(polygon, {{"size", 2e-3}}),
                                   many_holes(),
                                   zigzag(24'000),
                                   sweep_of_long_gaps(),
                                   sweep_of_many_parts(),
                                   unknown_members(),
                                   refined_often(),
                                   zigzag(9'000)};
  for (const json& problem : problems) {
    SCOPED_TRACE(problem.dump().substr(0, 100));
    withstand([&] { ask_about(problem, 8, port()); }, 8 * 16 * megabyte);
  }
}

/// Each takes some tenths of a second to read; who sends little does not wait behind them.
TEST_F(Hostile, ManyWhoAskAboutLongSweeps) {
  json problem = membrane_on({{"type", "rectangle"}}, {{"divisions", {8, 8}}});
  problem["boundary"]["bottom"] = {{"type", "contact"}};
  for (int i = 0; i < 5'000; ++i)
    problem["sweep"].push_back({{"boundary", {{"bottom", {{"gap", std::to_string(i) + "e-3*sin(x)"}}}}}});
  withstand([&] { ask_about(problem, sanitized ? 12 : 40, port()); }, 40 * megabyte);
}

/// A short body may be as costly as hundreds of looks: those do not wait behind 600 of them.
TEST_F(Hostile, ManyWhoAskAboutShortSweeps) {
  json problem = membrane_on({{"type", "rectangle"}}, {{"divisions", {8, 8}}});
  for (int i = 0; i < 1000; ++i) problem["sweep"].push_back({{"load", {{"body", i}}}});
  ASSERT_LT(problem.dump().size(), 32u * 1024);
  withstand([&] { ask_about(problem, sanitized ? 150 : 600, port()); }, 48 * megabyte);
}

TEST_F(Hostile, FourWhoSendAByteASecond) {
  withstand([&] { drip(4, "GET / HTTP/1.1\r\nX: ", "a", drip_time()); });
}

TEST_F(Hostile, ManyWhoSendAByteASecond) {
  withstand([&] { drip(200, "GET / HTTP/1.1\r\nX: ", "a", drip_time()); });
}

TEST_F(Hostile, ManyWhoSendTheirBodyAByteASecond) {
  withstand([&] { drip(200, post_head("Content-Length: 5000"), " ", drip_time()); });
}

TEST_F(Hostile, ManyWhoSendALongBodyAByteASecond) {
  withstand([&] {
    std::thread slow([&] { drip(200, post_head("Content-Length: 1000000"), " ", drip_time()); });
    std::this_thread::sleep_for(500ms);
    httplib::Client client("127.0.0.1", port());
    const auto reply = client.Post("/v1/validate", example("paper-nonconforming").dump(), "application/json");
    EXPECT_EQ(reply->status, 200);
    slow.join();
  });
}

TEST_F(Hostile, ManyWhoAskAndDoNotListen) {
  httplib::Client client("127.0.0.1", port());
  client.set_read_timeout(60);
  json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {160, 160};
  problem["solver"] = {{"method", "active_set"}};
  const auto solved = client.Post("/v1/solves?wait=100&fields=summary", problem.dump(), "application/json");
  ASSERT_EQ(solved->status, 200) << solved->body;
  const std::string path = "/v1/solves/" + std::string(json::parse(solved->body).at("id")) + "/result";
  ASSERT_GT(client.Get(path)->body.size(), 4 * megabyte);
  withstand([&] {
    std::vector<RawClient> deaf;
    for (int i = 0; i < 200; ++i) {
      deaf.emplace_back(port());
      deaf.back().send("GET " + path + "?fields=mesh HTTP/1.1\r\nHost: localhost\r\n\r\n");
    }
    std::this_thread::sleep_for(drip_time());
    EXPECT_EQ(client.Get("/v1/solves")->status, 200);
  });
}

/// While nothing is accepted, connections wait in the backlog.
TEST_F(Hostile, ACrowdAtTheDoor) {
  daemon_.process().signal(SIGSTOP);
  std::vector<RawClient> clients;
  for (int i = 0; i < 300; ++i) {
    clients.emplace_back(port());
    clients.back().send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  }
  daemon_.process().signal(SIGCONT);
  EXPECT_TRUE(listen_until(clients, 60s, [&] {
    return std::ranges::all_of(clients, [](const RawClient& client) { return client.status() == 200; });
  }));
}

/// slowhttptest's slow heads, slow bodies, ranges and slow reading, with 500 connections.
TEST_F(Hostile, Slowhttptest) {
  const std::string seconds = long_tests() ? "60" : "4";
  const std::string url = "http://127.0.0.1:" + std::to_string(port());
  for (const std::string& mode :
       {"-H -i 1 -u " + url + "/", "-B -i 1 -s 8192 -t POST -u " + url + "/v1/validate",
        "-R -a 1 -b 3000 -u " + url + "/v1/examples",
        "-X -w 1 -y 1 -n 1 -z 1 -k 3 -u " + url + "/v1/examples/plate-with-hole"}) {
    withstand([&] {
      const std::string command =
          "slowhttptest -c 500 -r 250 -p 2 -l " + seconds + " " + mode + " > /dev/null 2>&1";
      const int result = std::system(command.c_str());
      ASSERT_TRUE(WIFEXITED(result) && WEXITSTATUS(result) < 126) << command;
    });
  }
}

}  // namespace
}  // namespace signorini::server::hostile_test
