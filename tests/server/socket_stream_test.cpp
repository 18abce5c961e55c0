#include "server/http/socket_stream.hpp"

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

namespace signorini::server {
namespace {

/// A stream whose peer sees each send as a message of its own.
class SocketStreamTest : public testing::Test {
 protected:
  SocketStreamTest() : stop_(eventfd(0, 0)) {
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, sockets_), 0);
    stream_.emplace(sockets_[0], stop_, StreamLimits{}, slow_readers_);
  }
  ~SocketStreamTest() override {
    for (const int descriptor : {sockets_[0], sockets_[1], stop_}) ::close(descriptor);
  }

  void write(const std::string& bytes) {
    EXPECT_EQ(stream_->write(bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  /// The next message, or nothing if there is none yet.
  std::string received() {
    char bytes[1024];
    const ssize_t size = ::recv(sockets_[1], bytes, sizeof bytes, MSG_DONTWAIT);
    return {bytes, static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

  Places slow_readers_{1};
  int stop_;
  int sockets_[2];
  std::optional<SocketStream> stream_;
};

TEST_F(SocketStreamTest, SendsHeadAndBodyInOnePacket) {
  for (int reply = 0; reply < 2; ++reply) {
    write("head ");
    EXPECT_EQ(received(), "");
    write("body");
    EXPECT_EQ(received(), "head body");
    ASSERT_TRUE(stream_->finish_reply());
    EXPECT_EQ(received(), "");
  }
}

TEST_F(SocketStreamTest, HoldsNothingBackOfTheRestOfABody) {
  write("head ");
  for (const std::string piece : {"one", "two"}) {
    write(piece);
    EXPECT_NE(received().find(piece), std::string::npos);
  }
}

TEST_F(SocketStreamTest, SendsAHeadWithoutABodyWhenTheReplyEnds) {
  write("head");
  ASSERT_TRUE(stream_->finish_reply());
  EXPECT_EQ(received(), "head");
}

TEST_F(SocketStreamTest, SendsWhatTheClientWaitsForBeforeItReads) {
  write("100 Continue");
  ::send(sockets_[1], "{}", 2, 0);
  stream_->expect_body(2);
  char byte = 0;
  EXPECT_EQ(stream_->read(&byte, 1), 1);
  EXPECT_EQ(received(), "100 Continue");
}

}  // namespace
}  // namespace signorini::server
