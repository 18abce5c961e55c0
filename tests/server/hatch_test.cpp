#include "server/http/hatch.hpp"

#include <array>
#include <atomic>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace signorini::server::hatch_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// The client's end of a connection that takes little at once.
class Client {
 public:
  Client() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    socket_ = ends[0];
    const int little = 4096;
    setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &little, sizeof(little));
    connection_ = std::make_shared<Connection>(ends[1], stop_event_, MessageLimits(), slow_readers_, nullptr);
  }
  ~Client() {
    ::close(socket_);
    ::close(stop_event_);
  }

  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// The service's end.
  std::shared_ptr<Connection> connection() { return std::exchange(connection_, nullptr); }

  /// What comes within some seconds, until it is so long or the service closes.
  std::string read(std::size_t length) {
    std::string text;
    std::array<char, 4096> bytes;
    pollfd polled{socket_, POLLIN, 0};
    while (text.size() < length && ::poll(&polled, 1, 10'000) > 0) {
      const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
      if (count <= 0) break;
      text.append(bytes.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  bool is_left() const {
    pollfd polled{socket_, POLLRDHUP, 0};
    return ::poll(&polled, 1, 0) > 0;
  }

 private:
  int socket_ = -1;
  const int stop_event_ = eventfd(0, EFD_CLOEXEC);
  Semaphore slow_readers_{1};
  std::shared_ptr<Connection> connection_;
};

class AtTheHatch : public testing::Test {
 protected:
  static HatchLimits limits() {
    HatchLimits few;
    few.clients = 2;
    return few;
  }

  bool wait_for(const std::function<bool()>& condition) const {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(10ms);
    return condition();
  }

  const std::string reply_ = std::string(1 << 20, 'a') + "b";
  std::atomic<int> taken_ = 0, last_ = 0;
  Hatch hatch_{limits(), [this](const std::shared_ptr<Connection>&, bool goes_on) {
                 ++taken_;
                 if (!goes_on) ++last_;
               }};
};

TEST_F(AtTheHatch, NobodyWaitsForWhoReadsLater) {
  Client client;
  hatch_.deliver(client.connection(), reply_, true);
  EXPECT_EQ(taken_, 0);
  EXPECT_EQ(client.read(reply_.size()), reply_);
  EXPECT_TRUE(wait_for([&] { return taken_ == 1; }));
  EXPECT_EQ(last_, 0);
}

TEST_F(AtTheHatch, AShortReplyIsTakenAtOnce) {
  Client client;
  hatch_.deliver(client.connection(), "short", false);
  EXPECT_EQ(taken_, 1);
  EXPECT_EQ(last_, 1);
  EXPECT_EQ(client.read(5), "short");
}

TEST_F(AtTheHatch, WhoTakesTooLittleIsLeft) {
  HatchLimits short_time;
  short_time.write.time = 1s;
  Hatch hatch(short_time, [this](auto&&...) { ++taken_; });
  Client client;
  hatch.deliver(client.connection(), reply_, true);
  EXPECT_TRUE(wait_for([&] { return client.is_left(); }));
  EXPECT_EQ(taken_, 0);
}

TEST_F(AtTheHatch, WhoHasTakenNothingForTheLongestTimeMakesRoom) {
  Client first, second, third;
  hatch_.deliver(first.connection(), reply_, true);
  hatch_.deliver(second.connection(), reply_, true);
  first.read(100'000);
  EXPECT_FALSE(first.is_left() || second.is_left());
  std::this_thread::sleep_for(50ms);
  hatch_.deliver(third.connection(), reply_, true);
  EXPECT_FALSE(first.is_left());
  EXPECT_TRUE(second.is_left());
}

TEST_F(AtTheHatch, WhoStillTakesWhenAllEndsHasAMoment) {
  Client client;
  hatch_.deliver(client.connection(), reply_, false);
  std::thread reader([&] { EXPECT_EQ(client.read(reply_.size()), reply_); });
  hatch_.stop();
  reader.join();
  EXPECT_EQ(last_, 1);
}

}  // namespace
}  // namespace signorini::server::hatch_test
