#include "server/http/pending_connections.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace signorini::server::pending_connections_test {
namespace {

using namespace std::chrono_literals;

/// Pending connections without a service behind it, whose clients are soon late.
class PendingConnectionsTest : public testing::Test {
 protected:
  ~PendingConnectionsTest() override {
    pending_.stop();
    for (const int socket : sockets_) ::close(socket);
    ::close(stop_event_);
  }

  static PendingLimits limits() {
    PendingLimits little;
    little.connections = 3;
    little.long_bodies = 200'000;
    little.head_time = little.let_in = 1s;
    return little;
  }

  /// The client's end of a new connection, on which this was said.
  int enter(const std::string& said, std::shared_ptr<void> place = nullptr) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    sockets_.push_back(ends[0]);
    pending_.admit(
        std::make_shared<Connection>(ends[1], stop_event_, MessageLimits(), slow_readers_, std::move(place)));
    ::send(ends[0], said.data(), said.size(), 0);
    return ends[0];
  }

  int enter_with_body(std::size_t declared) {
    return enter("POST /v1/validate HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                 std::to_string(declared) + "\r\n\r\n");
  }

  /// The next message that has come whole; one without a method if none does for some seconds.
  Message next() {
    std::unique_lock lock(mutex_);
    if (!came_.wait_for(lock, 10s, [&] { return !messages_.empty(); })) return {};
    Message message = std::move(messages_.front());
    messages_.erase(messages_.begin());
    return message;
  }

  static int status_of(const Message& message) { return message.refusal ? message.refusal->status : 0; }

  const int stop_event_ = eventfd(0, EFD_CLOEXEC);
  Semaphore slow_readers_{1};
  std::vector<int> sockets_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Message> messages_;
  std::vector<std::shared_ptr<void>> rooms_;
  PendingConnections pending_{
      limits(), [](Connection&) { return false; },
      [this](const std::shared_ptr<Connection>& connection, std::shared_ptr<void> room) {
        const std::lock_guard lock(mutex_);
        messages_.push_back(connection->reader().next());
        rooms_.push_back(std::move(room));
        came_.notify_one();
      }};
};

TEST_F(PendingConnectionsTest, ARequestThatComesTooLateIsRefused) {
  enter("GET / HTTP/1.1\r\nHost: l");
  EXPECT_EQ(status_of(next()), 408);
}

/// Whoever has waited longest makes room for who comes, whatever the numbers of their sockets.
TEST_F(PendingConnectionsTest, AreClosedInTheOrderInWhichTheyCame) {
  const auto is_closed = [](int client) {
    char byte = 0;
    return ::recv(client, &byte, 1, MSG_DONTWAIT) == 0;
  };
  std::vector<int> clients;
  for (int i = 0; i < 6; ++i) {
    std::shared_ptr<void> place = pending_.take_place();
    ASSERT_TRUE(place);
    clients.push_back(enter("", std::move(place)));
    for (int k = 0; k <= i; ++k) EXPECT_EQ(is_closed(clients[k]), k <= i - 3) << k << " of " << i;
  }
}

/// Chunks of a byte take long to read: who asks for something without a body does not wait until all have
/// been. A pause of the machine may let the thread read them before the question comes, but not each time.
TEST_F(PendingConnectionsTest, HeadsAreReadBeforeBodies) {
  constexpr int with_body = 60;
  std::string body;
  for (int i = 0; i < 2500; ++i) body += "1\r\n \r\n";
  body += "0\r\n\r\n";
  int least = with_body;
  for (int attempt = 0; attempt < 5 && least >= with_body / 2; ++attempt) {
    std::vector<int> clients;
    for (int i = 0; i < with_body; ++i)
      clients.push_back(enter("POST / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"));
    const int looking = enter("");
    std::this_thread::sleep_for(50ms);
    for (const int client : clients) ::send(client, body.data(), body.size(), 0);
    const std::string look = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
    ::send(looking, look.data(), look.size(), 0);
    int before = with_body;
    for (int i = 0; i <= with_body; ++i)
      if (next().method == "GET") before = i;
    least = std::min(least, before);
  }
  EXPECT_LT(least, with_body / 2);
}

/// RFC 9110, 9.3.2.
TEST_F(PendingConnectionsTest, AHeadThatComesTooLateIsRefusedAsHead) {
  enter("HEAD / HTTP/1.1\r\nHost: l");
  const Message message = next();
  EXPECT_EQ(status_of(message), 408);
  EXPECT_EQ(message.method, "HEAD");
}

TEST_F(PendingConnectionsTest, ABodyForWhichThereIsNoRoomIsNotCalledLate) {
  enter_with_body(90'000);
  enter_with_body(90'000);
  EXPECT_EQ(status_of(next()), 503);
}

/// Half of what is left is for those who want less.
TEST_F(PendingConnectionsTest, ThereIsRoomForAShorterBody) {
  enter_with_body(90'000);
  enter_with_body(90'000);
  const int socket = enter_with_body(40'000);
  const std::string body(40'000, ' ');
  ::send(socket, body.data(), body.size(), 0);
  const Message message = next();
  EXPECT_EQ(status_of(message), 0);
  EXPECT_EQ(message.body, body);
}

/// What was kept for the longest body that could come is given back when a shorter one has come.
TEST_F(PendingConnectionsTest, ABodyThatHasComeKeepsTheRoomThatItTakes) {
  const std::string body(40'000, ' ');
  const int first = enter_with_body(body.size());
  ::send(first, body.data(), body.size(), 0);
  EXPECT_EQ(next().body.size(), body.size());
  const int second = enter_with_body(body.size());
  ::send(second, body.data(), body.size(), 0);
  EXPECT_EQ(next().body.size(), body.size());
  enter_with_body(70'000);
  EXPECT_EQ(status_of(next()), 503);
  rooms_.clear();
  const std::string longer(70'000, ' ');
  const int third = enter_with_body(longer.size());
  ::send(third, longer.data(), longer.size(), 0);
  EXPECT_EQ(next().body.size(), longer.size());
}

}  // namespace
}  // namespace signorini::server::pending_connections_test
