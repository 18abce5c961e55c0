// Crowds that send next to nothing: what each of them holds is little, and everybody else is answered.

#include "running_service.hpp"

#include <algorithm>
#include <thread>

#include <unistd.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "api/document/gzip.hpp"
#include "child_process.hpp"
#include "example_problems.hpp"
#include "process_figures.hpp"
#include "raw_client.hpp"
#include "reply_reader.hpp"

namespace signorini::server::guests_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

/// Sanitizers take their time.
constexpr int patience = sanitized ? 10 : 1;

std::string post_head(const std::string& headers) {
  return "POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" + headers +
         "\r\n\r\n";
}

class Guests : public testing::Test {
 protected:
  int port() const { return daemon_.port(); }

  std::vector<RawClient> crowd(std::size_t count, const std::string& said) {
    std::vector<RawClient> clients;
    for (std::size_t i = 0; i < count; ++i) {
      clients.emplace_back(port());
      clients.back().send(said);
    }
    std::this_thread::sleep_for(200ms * patience);
    return clients;
  }

  /// List and status within a second, health within 100 ms.
  void expect_service() {
    expect_reply("/healthz", 100ms);
    expect_reply("/v1/solves", 1s);
    const auto begin = Clock::now();
    httplib::Client client("127.0.0.1", port());
    const auto reply = client.Post("/v1/validate", "{}", "application/json");
    ASSERT_TRUE(reply) << httplib::to_string(reply.error());
    EXPECT_EQ(reply->status, 422);
    EXPECT_LT(Clock::now() - begin, 1s * patience);
  }

  void expect_reply(const std::string& path, std::chrono::milliseconds time) {
    const auto begin = Clock::now();
    httplib::Client client("127.0.0.1", port());
    const auto reply = client.Get(path);
    ASSERT_TRUE(reply) << path << ' ' << httplib::to_string(reply.error());
    EXPECT_EQ(reply->status, 200);
    EXPECT_LT(Clock::now() - begin, time * patience) << path;
  }

  Daemon daemon_;
};

/// What two readers of a request once understood otherwise: 140 of each held every thread for 300 s.
TEST_F(Guests, WhoseBodiesNeverEnd) {
  const std::vector<std::string> heads{post_head("Transfer-Encoding: Chunked"),
                                       post_head("Transfer-Encoding: chunked "),
                                       post_head("Transfer-Encoding: chunked") + "-5\r\n",
                                       post_head("Content-Length: %31%30%30%30"),
                                       post_head("Content-Length: 100000"),
                                       post_head("Content-Length: 100"),
                                       post_head("Expect: 100-continue\r\nContent-Length: 100000")};
  for (const std::string& head : heads) {
    SCOPED_TRACE(head);
    const std::vector<RawClient> guests = crowd(140, head);
    expect_service();
  }
}

/// None of them is a second request.
TEST_F(Guests, WhoHideARequestInABody) {
  const std::string hidden = "GET /v1/examples HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const std::string length = std::to_string(hidden.size());
  for (const std::string& framing :
       {"Content-Length : " + length, "Content-Length:\r\n " + length, std::string("Content-Length:"),
        std::string("Transfer-Encoding:"), std::string("Transfer-Encoding:\r\n chunked")}) {
    std::vector<RawClient> client = crowd(1, post_head(framing) + hidden);
    EXPECT_TRUE(listen_until(client, 20s, [&] { return client[0].closed(); })) << framing;
    EXPECT_EQ(client[0].status(), 400) << framing;
    EXPECT_EQ(client[0].heard().find("paper-nonconforming"), std::string::npos) << framing;
  }
}

/// As many as may be open wait with long bodies; a new one is let in.
TEST_F(Guests, WhoFillTheHouseWithLongBodies) {
  const std::size_t before = figures_of(daemon_.process().id()).memory;
  const std::vector<RawClient> guests = crowd(4200, post_head("Content-Length: 1000000"));
  expect_service();
  if (!sanitized) {
    EXPECT_LT(figures_of(daemon_.process().id()).memory, before + 4200 * 16 * 1024);
  }
}

/// A long body that comes slowly gives its place to others after some seconds.
TEST_F(Guests, WhoseLongBodiesStandInTheWay) {
  const std::vector<RawClient> guests = crowd(30, post_head("Content-Length: 1000000"));
  httplib::Client client("127.0.0.1", port());
  client.set_read_timeout(50);
  // 30 of them by 16 at a time, for 5 s each.
  const auto begin = Clock::now();
  const auto reply = client.Post("/v1/validate", "{}" + std::string(100'000, ' '), "application/json");
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 422);
  EXPECT_LT(Clock::now() - begin, 30s);
}

/// What they do not take holds no thread, and whoever reads after all gets every reply.
TEST_F(Guests, WhoAskAgainAndAgainAndReadNothing) {
  const std::string line = "GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n";
  std::string requests;
  for (int i = 0; i < 149; ++i) requests += line + "\r\n";
  requests += line + "Connection: close\r\n\r\n";
  const std::vector<RawClient> guests = [&] {
    std::vector<RawClient> deaf;
    for (int i = 0; i < 200; ++i) {
      deaf.emplace_back(port());
      deaf.back().turn_deaf();
      deaf.back().send(requests);
    }
    return deaf;
  }();
  std::vector<RawClient> reader;
  reader.emplace_back(port());
  reader[0].send(requests);
  for (int i = 0; i < 8; ++i) {
    expect_service();
    std::this_thread::sleep_for(250ms);
  }
  EXPECT_TRUE(listen_until(reader, 20s * patience, [&] { return reader[0].closed(); }));
  EXPECT_EQ(read_replies(reader[0].heard(), false).size(), 150u);
}

/// Found from outside: each kept a copy of its last reply.
TEST_F(Guests, WhoHaveReadAllAndStay) {
  const auto memory = [&] { return figures_of(daemon_.process().id()).memory; };
  constexpr std::size_t count = 500, a_guest = 16 * 1024;
  const std::string asked = "GET /openapi.json HTTP/1.1\r\nHost: localhost\r\n\r\n";
  expect_reply("/openapi.json", 1s);
  const std::size_t before = memory();
  std::vector<RawClient> guests = crowd(count, asked);
  EXPECT_TRUE(listen_until(guests, 20s * patience, [&] {
    return std::ranges::all_of(guests, [](const RawClient& guest) { return guest.heard().size() > 100'000; });
  }));
  if (!sanitized) {
    EXPECT_LT(memory(), before + count * a_guest + 8 * megabyte);
  }
}

/// Found from outside: their pictures were drawn one after the other, for 20 s.
TEST_F(Guests, WhoAskForPicturesAndLeave) {
  httplib::Client client("127.0.0.1", port());
  json problem = example("paper-nonconforming");
  problem["mesh"]["divisions"] = {64, 64};
  const auto solved = client.Post("/v1/solves?wait=60&fields=summary", problem.dump(), "application/json");
  ASSERT_TRUE(solved);
  const std::string path = "/v1/solves/" + std::string(json::parse(solved->body).at("id")) + "/picture.svg";
  ASSERT_GT(client.Get(path)->body.size(), 100'000);
  const int before = figures_of(daemon_.process().id()).descriptors;
  crowd(500, "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n").clear();
  const auto until = Clock::now() + 1s * patience;
  while (figures_of(daemon_.process().id()).descriptors > before + 20 && Clock::now() < until)
    std::this_thread::sleep_for(10ms);
  EXPECT_LE(figures_of(daemon_.process().id()).descriptors, before + 20);
  expect_service();
}

/// Each has left, whatever it had said before, and keeps nothing though it stays.
TEST_F(Guests, WhoCloseTheirSideAndStay) {
  const std::vector<std::string> said{"",
                                      "GET /healthz HTTP/1.1\r\nHo",
                                      "GET /v1/solves HTTP/1.1\r\nHost: localhost\r\n\r\n",
                                      "GET / HTTP/1.1\r\nHost: a b\r\n\r\n",
                                      post_head("Content-Length: 500") + "{",
                                      post_head("Content-Length: 500000") + "{",
                                      post_head("Transfer-Encoding: chunked") + "5\r\n{",
                                      post_head("Content-Length: 2") + "{}"};
  const int before = figures_of(daemon_.process().id()).descriptors;
  for (const std::string& each : said) {
    SCOPED_TRACE(each);
    const std::vector<RawClient> guests = crowd(200, each);
    for (const RawClient& guest : guests) guest.end_sending();
    expect_service();
    const auto until = Clock::now() + 1s * patience;
    while (figures_of(daemon_.process().id()).descriptors > before + 20 && Clock::now() < until)
      std::this_thread::sleep_for(10ms);
    EXPECT_LE(figures_of(daemon_.process().id()).descriptors, before + 20);
  }
}

/// A document of some megabytes that takes some tenths of a second to read, in few bytes.
std::string costly_body() {
  std::string text = R"({"domain": {"type": "mesh", "points": [[0, 0])";
  while (text.size() < 6 * megabyte) text += ", [0, 0]";
  text += R"(], "triangles": [[0, 1, 2]], "boundary": {}}})";
  std::string bytes;
  const api::Sink append = [&](std::string_view piece) {
    bytes += piece;
    return true;
  };
  api::Gzip gzip(append);
  gzip.put(text);
  gzip.finish();
  return bytes;
}

class Readings : public Guests {
 protected:
  std::vector<RawClient> crowd_with_costly_bodies() {
    const std::string body = costly_body();
    return crowd(
        200, post_head("Content-Encoding: gzip\r\nContent-Length: " + std::to_string(body.size())) + body);
  }

  /// Of a body that is too long to be read beside others.
  void expect_reading() {
    const auto begin = Clock::now();
    httplib::Client client("127.0.0.1", port());
    client.set_read_timeout(100);
    const auto reply = client.Post("/v1/validate", "{}" + std::string(40'000, ' '), "application/json");
    ASSERT_TRUE(reply) << httplib::to_string(reply.error());
    EXPECT_EQ(reply->status, 422);
    EXPECT_LT(Clock::now() - begin, 4s * patience);
  }
};

/// What 200 had left behind was read for a minute, and so long did others wait.
TEST_F(Readings, AreNotBegunForThoseWhoHaveLeft) {
  crowd_with_costly_bodies();
  expect_reading();
  const auto descriptors = [&] { return figures_of(daemon_.process().id()).descriptors; };
  const auto until = Clock::now() + 2s * patience;
  while (descriptors() >= 50 && Clock::now() < until) std::this_thread::sleep_for(10ms);
  EXPECT_LT(descriptors(), 50);
}

TEST_F(Readings, AreThoseOfShorterBodiesFirst) {
  const std::vector<RawClient> guests = crowd_with_costly_bodies();
  for (int i = 0; i < 3; ++i) expect_reading();
}

class Waiters : public ServiceTest {
 protected:
  int waiting() {
    const std::string text = get("/metrics")->body;
    const std::string name = "\nsignorini_waiting_clients ";
    return std::stoi(text.substr(text.find(name) + name.size()));
  }

  /// How many wait, once they are so many, or some seconds later.
  int waiting_once(int number) {
    const auto until = Clock::now() + 5s * patience;
    while (waiting() != number && Clock::now() < until) std::this_thread::sleep_for(20ms);
    return waiting();
  }
};

/// 140 of them on one idempotency key once held all threads for an hour, after they had left.
TEST_F(Waiters, HoldNoThreadsAndAreNoticedWhenTheyLeave) {
  constexpr int count = 300;
  const std::string body = problem_titled("slow");
  const std::string request =
      "POST /v1/solves?wait=3600 HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
      "Idempotency-Key: one\r\nContent-Length: " +
      std::to_string(body.size()) + "\r\n\r\n" + body;
  const int threads = figures_of(::getpid()).threads;
  std::vector<RawClient> guests;
  for (int i = 0; i < count; ++i) {
    guests.emplace_back(service_.port());
    guests.back().send(request);
  }
  EXPECT_EQ(waiting_once(count), count);
  EXPECT_LE(figures_of(::getpid()).threads, threads + 2);
  const auto begin = Clock::now();
  EXPECT_EQ(get("/v1/solves")->status, 200);
  EXPECT_LT(Clock::now() - begin, 1s * patience);

  while (guests.size() > 1) guests.pop_back();
  EXPECT_EQ(waiting_once(1), 1);
  // Who stays is answered when the solve ends.
  const json list = json::parse(get("/v1/solves")->body);
  ASSERT_EQ(list.at("solves").size(), 1u);
  client_.Delete("/v1/solves/" + list.at("solves").at(0).at("id").get<std::string>());
  EXPECT_TRUE(listen_until(guests, 5s * patience, [&] { return guests[0].status() == 200; }));
  EXPECT_EQ(waiting_once(0), 0);
}

}  // namespace
}  // namespace signorini::server::guests_test
