#include "raw_client.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace signorini::server {

RawClient::RawClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ADD_FAILURE() << "cannot connect: errno " << errno;
  }
}

RawClient::~RawClient() {
  close();
}

RawClient::RawClient(RawClient&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), closed_(other.closed_), heard_(std::move(other.heard_)) {}

void RawClient::turn_deaf() const {
  const int little = 4096;
  setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &little, sizeof(little));
}

bool RawClient::send(const std::string& bytes) const {
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

void RawClient::end_sending() const {
  ::shutdown(socket_, SHUT_WR);
}

void RawClient::receive() {
  std::array<char, 64 * 1024> bytes;
  while (!closed_) {
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    closed_ = count <= 0;
    if (count > 0) heard_.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

void RawClient::close() {
  if (socket_ >= 0) ::close(std::exchange(socket_, -1));
}

int RawClient::status() const {
  return heard_.starts_with("HTTP/1.1 ") ? std::atoi(heard_.c_str() + 9) : 0;
}

void wait_for_bytes(const std::vector<RawClient>& clients, std::chrono::milliseconds time) {
  std::vector<pollfd> descriptors;
  for (const RawClient& client : clients) {
    if (!client.closed()) descriptors.push_back({client.socket(), POLLIN, 0});
  }
  ::poll(descriptors.data(), descriptors.size(), static_cast<int>(time.count()));
}

}  // namespace signorini::server
