#include "running_service.hpp"

#include <atomic>
#include <thread>

#include "becomes.hpp"

namespace signorini::server::stop_test {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

void wait_for_solves(httplib::Client& client, std::size_t count) {
  EXPECT_TRUE(
      becomes([&] { return json::parse(client.Get("/v1/solves")->body).at("solves").size() == count; }));
}

TEST(Stop, EndsEveryJobAndAnswersThoseWhoWait) {
  ServiceOptions options;
  options.queue_limit = 6;
  RunningService service(options);
  std::atomic<int> answered = 0;
  std::vector<std::thread> clients;
  for (int i = 0; i < 6; ++i) {
    clients.emplace_back([&] {
      httplib::Client client("127.0.0.1", service.port());
      client.set_read_timeout(100);
      const auto reply = client.Post("/v1/solves?wait=30", problem_titled("slow"), "application/json");
      if (reply && reply->status == 200 && json::parse(reply->body).at("status") == "cancelled") ++answered;
    });
  }
  httplib::Client watcher("127.0.0.1", service.port());
  wait_for_solves(watcher, 6);
  const auto begin = Clock::now();
  service.stop();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(5));
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(answered, 6);
}

TEST(Stop, IsNotDelayedByIdleConnectionsOrHalfSentRequests) {
  RunningService service;
  httplib::Client idle("127.0.0.1", service.port());
  idle.set_keep_alive(true);
  ASSERT_EQ(idle.Get("/healthz")->status, 200);
  std::thread half([&] {
    send_raw(service.port(),
             "POST /v1/solves HTTP/1.1\r\nContent-Type: application/json\r\nContent-Length: 99\r\n\r\n{");
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto begin = Clock::now();
  service.stop();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(3));
  half.join();
}

TEST(Stop, UnderLoadLosesNoReply) {
  RunningService service;
  std::atomic<bool> stopping = false;
  std::atomic<int> broken = 0;
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&] {
      while (!stopping) {
        httplib::Client client("127.0.0.1", service.port());
        const auto reply = client.Post("/v1/solves?wait=1", problem_titled("instant"), "application/json");
        // 503 is a reply; none at all is only in order once the service stops.
        if (!reply && !stopping) ++broken;
      }
    });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  stopping = true;
  service.stop();
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(broken, 0);
}

TEST(Health, IsAnsweredWhileClientsWait) {
  ServiceOptions options;
  options.queue_limit = 8;
  RunningService service(options);
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&] {
      httplib::Client client("127.0.0.1", service.port());
      client.set_read_timeout(100);
      client.Post("/v1/solves?wait=30", problem_titled("slow"), "application/json");
    });
  }
  httplib::Client watcher("127.0.0.1", service.port());
  wait_for_solves(watcher, 8);
  const auto begin = Clock::now();
  EXPECT_EQ(watcher.Get("/healthz")->status, 200);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(5));
  service.stop();
  for (std::thread& client : clients) client.join();
}

TEST(Listener, TwoCannotShareAPort) {
  RunningService service;
  Access access;
  const Router router({}, access);
  EXPECT_THROW(Listener({"127.0.0.1", service.port(), 1, 1024}, router), CannotListen);
}

}  // namespace
}  // namespace signorini::server::stop_test
