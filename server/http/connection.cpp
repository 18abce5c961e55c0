#include "server/http/connection.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <linux/sockios.h>
#include <netdb.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/thread_pool.hpp"

namespace signorini::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int nobody = -1;

/// Waits until the descriptor is ready or the time is over; an interrupted wait goes on.
bool poll_until(int descriptor, short events, Clock::time_point until) {
  pollfd polled{descriptor, events, 0};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    const int ready = ::poll(&polled, 1, static_cast<int>(std::max<decltype(left)>(0, left)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

std::string address_of_client(int socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXHOST> host{};
  if (::getpeername(socket, generic, &length) != 0) return {};
  if (getnameinfo(generic, length, host.data(), host.size(), nullptr, 0, NI_NUMERICHOST) != 0) return {};
  return host.data();
}

}  // namespace

Connection::Connection(int socket, int stop_event, const MessageLimits& limits, Semaphore& slow_readers,
                       std::shared_ptr<void> place)
    : place_(std::move(place)),
      socket_(socket),
      remote_address_(address_of_client(socket)),
      stop_event_(stop_event),
      slow_readers_(slow_readers),
      reader_(limits) {}

Connection::~Connection() {
  if (socket_ == nobody) return;
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

bool Connection::has_left() const {
  return poll_until(socket_, POLLRDHUP, Clock::now());
}

bool Connection::is_gone() const {
  return poll_until(socket_, 0, Clock::now());
}

Receipt Connection::receive(std::size_t most) {
  std::array<char, kReceived> bytes;
  const ssize_t count = ::recv(socket_, bytes.data(), std::min(most, bytes.size()), MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return Receipt::nothing;
  if (count <= 0) return Receipt::closed;
  if (!ended_) reader_.take({bytes.data(), static_cast<std::size_t>(count)});
  return Receipt::bytes;
}

bool Connection::stopping() const {
  return poll_until(stop_event_, POLLIN, Clock::now());
}

/// The system keeps megabytes for a client who reads nothing: they do not count.
std::uint64_t Connection::acknowledged() const {
  int unacknowledged = 0;
  ::ioctl(socket_, SIOCOUTQ, &unacknowledged);
  return sent_ - static_cast<std::uint64_t>(unacknowledged);
}

/// Whether others wait for what the client keeps, and it has taken little of it in the last seconds.
bool Connection::is_in_the_way() {
  const auto time = Clock::now() - paced_since_;
  if (time > limits_.slow) {
    const std::uint64_t taken = acknowledged();
    is_slow_ =
        static_cast<double>(taken - paced_from_) < limits_.rate * std::chrono::duration<double>(time).count();
    paced_since_ += time;
    paced_from_ = taken;
  }
  return is_slow_ && (slow_readers_.acquired() >= slow_readers_.count() || (in_the_way_ && in_the_way_()));
}

/// In one of the places for slow readers; false if there is none in time either.
bool Connection::wait_in_place(Clock::time_point until) {
  constexpr auto look_around = std::chrono::milliseconds(250);
  const auto give_up = std::min(until, Clock::now() + limits_.slow);
  std::shared_ptr<void> place;
  while (Clock::now() < until) {
    if (!place) place = slow_readers_.try_acquire();
    if (is_in_the_way() || (!place && Clock::now() > give_up)) return false;
    if (poll_until(socket_, POLLOUT, std::min(until, Clock::now() + look_around))) return true;
  }
  return false;
}

/// False if the client takes too little.
bool Connection::wait_writable() {
  constexpr auto moment = std::chrono::milliseconds(20);
  if (poll_until(socket_, POLLOUT, Clock::now())) return true;
  const ThreadPool::Waiting rest;
  if (poll_until(socket_, POLLOUT, Clock::now() + moment)) return true;
  if (Clock::now() - patient_since_ > limits_.time) {
    if (sent_ - patient_from_ < limits_.bytes) return false;
    patient_since_ = Clock::now();
    patient_from_ = sent_;
  }
  return wait_in_place(Clock::now() + (stopping() ? std::chrono::seconds(1) : limits_.time));
}

void Connection::put(std::string reply) {
  reply_.swap(reply);  // moved into, a string keeps the memory of what it held where the new one is short
  delivered_ = 0;
}

Delivery Connection::deliver() {
  while (undelivered() > 0) {
    const ssize_t sent =
        ::send(socket_, reply_.data() + delivered_, undelivered(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) return Delivery::part;
    if (sent <= 0) return Delivery::failed;
    delivered_ += static_cast<std::size_t>(sent);
    sent_ += static_cast<std::uint64_t>(sent);
  }
  put({});
  return Delivery::whole;
}

void Connection::begin_reply(std::function<bool()> in_the_way) {
  in_the_way_ = std::move(in_the_way);
  patient_since_ = paced_since_ = Clock::now();
  patient_from_ = sent_;
  paced_from_ = acknowledged();
  is_slow_ = false;
}

bool Connection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    if (!wait_writable()) {
      forget_unsent();
      return false;
    }
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (sent <= 0) return false;
    sent_ += static_cast<std::uint64_t>(sent);
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

void Connection::forget_unsent() const {
  const linger at_once{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
}

void Connection::send_at_once(std::string_view text) const {
  [[maybe_unused]] const ssize_t sent =
      ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Connection::end_sending() {
  ended_ = true;
  ::shutdown(socket_, SHUT_WR);
}

int Connection::give_away() {
  return std::exchange(socket_, nobody);
}

}  // namespace signorini::server
