#include "server/http/socket_stream.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/http/crew.hpp"

namespace signorini::server {
namespace {

using Clock = std::chrono::steady_clock;

int milliseconds_until(Clock::time_point until) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  return static_cast<int>(std::max<decltype(left)>(0, left));
}

/// Waits until one of the descriptors is ready or the time is over; an interrupted wait goes on.
template <std::size_t n>
bool poll_until(std::array<pollfd, n>& descriptors, Clock::time_point until) {
  for (;;) {
    const int ready = ::poll(descriptors.data(), n, milliseconds_until(until));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

using NameOf = int (*)(int, sockaddr*, socklen_t*);

void read_address(NameOf name_of, int socket, std::string& ip, int& port) {
  sockaddr_storage address{};
  socklen_t length = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  if (name_of(socket, generic, &length) != 0) return;
  if (getnameinfo(generic, length, host.data(), host.size(), service.data(), service.size(),
                  NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
    return;
  }
  ip = host.data();
  port = std::atoi(service.data());
}

}  // namespace

SocketStream::SocketStream(int socket, int stop_event, const StreamLimits& limits, Places& slow_readers)
    : socket_(socket), stop_event_(stop_event), limits_(limits), slow_readers_(slow_readers) {}

bool SocketStream::stopping() const {
  std::array<pollfd, 1> stop{{{stop_event_, POLLIN, 0}}};
  return poll_until(stop, Clock::now());
}

bool SocketStream::wait_readable(Clock::time_point until) const {
  std::array<pollfd, 2> both{{{socket_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
  if (!poll_until(both, Clock::now())) {
    const Crew::Rest rest;
    if (!poll_until(both, until)) return false;
  }
  return both[1].revents == 0;
}

Receipt SocketStream::receive() {
  std::array<char, 16 * 1024> bytes;
  const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return Receipt::nothing;
  if (count <= 0) return Receipt::closed;
  buffer_.erase(0, begin_);
  begin_ = 0;
  buffer_.append(bytes.data(), static_cast<std::size_t>(count));
  return Receipt::bytes;
}

void SocketStream::forget_buffered() {
  buffer_ = std::string();
  begin_ = 0;
}

void SocketStream::begin_request() {
  allowed_ = limits_.head_bytes;
  deadline_ = Clock::now() + limits_.head;
}

void SocketStream::expect_body(std::uint64_t bytes) {
  allowed_ = bytes;
  deadline_ = Clock::now() + limits_.body;
}

bool SocketStream::fill() {
  // What the client waits for before it sends more: "100 Continue".
  if (!finish_reply()) return false;
  Receipt receipt = Receipt::nothing;
  while (receipt == Receipt::nothing && wait_readable(deadline_)) receipt = receive();
  return receipt == Receipt::bytes;
}

ssize_t SocketStream::read(char* data, size_t size) {
  if (allowed_ == 0) return -1;
  if (buffered().empty() && !fill()) return -1;
  const std::size_t count = std::min({size, buffered().size(), static_cast<std::size_t>(allowed_)});
  std::memcpy(data, buffered().data(), count);
  begin_ += count;
  allowed_ -= count;
  if (buffered().empty()) forget_buffered();
  if (allowed_ == 0) body_is_over();
  return static_cast<ssize_t>(count);
}

ssize_t SocketStream::write(const char* data, size_t size) {
  if (!replying_) {
    replying_ = true;
    patient_since_ = Clock::now();
    taken_since_ = 0;
    held_.assign(data, size);
    return static_cast<ssize_t>(size);
  }
  if (held_.empty()) return send(data, size);
  held_.append(data, size);
  return send_held() ? static_cast<ssize_t>(size) : -1;
}

bool SocketStream::finish_reply() {
  replying_ = false;
  return send_held();
}

/// False if the client takes too little, or is one slow reader too many.
bool SocketStream::wait_writable() {
  constexpr auto moment = std::chrono::milliseconds(20);
  std::array<pollfd, 1> writable{{{socket_, POLLOUT, 0}}};
  if (poll_until(writable, Clock::now())) return true;
  const Crew::Rest rest;
  if (poll_until(writable, Clock::now() + moment)) return true;
  if (Clock::now() - patient_since_ > limits_.write) {
    if (taken_since_ < limits_.write_bytes) return false;
    patient_since_ = Clock::now();
    taken_since_ = 0;
  }
  const std::shared_ptr<void> place = slow_readers_.take();
  const auto patience = stopping() ? std::chrono::seconds(1) : limits_.write;
  return place && poll_until(writable, Clock::now() + patience);
}

ssize_t SocketStream::send(const char* data, size_t size) {
  if (!wait_writable()) return -1;
  const ssize_t count = ::send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  taken_since_ += static_cast<std::uint64_t>(std::max<ssize_t>(count, 0));
  return count;
}

bool SocketStream::send_held() {
  std::string_view left = held_;
  while (!left.empty()) {
    const ssize_t sent = send(left.data(), left.size());
    if (sent <= 0) return false;
    left.remove_prefix(static_cast<std::size_t>(sent));
  }
  held_.clear();
  return true;
}

void SocketStream::send_at_once(std::string_view text) const {
  [[maybe_unused]] const ssize_t sent =
      ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void SocketStream::end_sending() const {
  ::shutdown(socket_, SHUT_WR);
}

bool SocketStream::is_readable() const {
  return !buffered().empty() || wait_readable(Clock::now());
}

bool SocketStream::is_writable() const {
  std::array<pollfd, 1> writable{{{socket_, POLLOUT, 0}}};
  return poll_until(writable, Clock::now()) && (writable[0].revents & (POLLERR | POLLHUP)) == 0;
}

void SocketStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  read_address(&getpeername, socket_, ip, port);
}

void SocketStream::get_local_ip_and_port(std::string& ip, int& port) const {
  read_address(&getsockname, socket_, ip, port);
}

}  // namespace signorini::server
