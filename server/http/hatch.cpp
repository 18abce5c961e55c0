#include "server/http/hatch.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace signorini::server {
namespace {

constexpr int look_at_replies_ms = 250;  // how late somebody is left

}  // namespace

Hatch::Hatch(const HatchLimits& limits, Taken taken)
    : limits_(limits),
      taken_(std::move(taken)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  epoll_event wake{EPOLLIN, {.fd = wake_event_}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_event_, &wake);
  thread_ = std::thread(&Hatch::run, this);
}

Hatch::~Hatch() {
  stop();
  ::close(epoll_);
  ::close(wake_event_);
}

void Hatch::deliver(std::shared_ptr<Connection> connection, std::string reply, bool goes_on) {
  connection->put(std::move(reply));
  const Delivery delivery = connection->deliver();
  if (delivery == Delivery::whole) return taken_(std::move(connection), goes_on);
  if (delivery == Delivery::failed) return;
  const int socket = connection->socket();
  const std::size_t left = connection->undelivered();
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  bytes_ += left;
  clients_.emplace(socket, Client{std::move(connection), goes_on, left, now, now + limits_.write.time, left});
  epoll_event writable{EPOLLOUT, {.fd = socket}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &writable);
  while (clients_.size() > limits_.clients || bytes_ > limits_.bytes) leave_one();
}

void Hatch::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (closes_) return;
    closes_ = Clock::now() + limits_.last_call;
  }
  ::eventfd_write(wake_event_, 1);
  thread_.join();
  clients_.clear();
}

void Hatch::run() {
  auto look_around = Clock::now();
  while (!is_over()) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(epoll_, events.data(), events.size(), look_at_replies_ms);
    {
      const std::lock_guard lock(mutex_);
      for (int i = 0; i < count; ++i) serve(events[i].data.fd);
      if (Clock::now() >= look_around) {
        leave_slow_ones();
        look_around = Clock::now() + std::chrono::milliseconds(look_at_replies_ms);
      }
    }
    for (Client& client : std::exchange(done_, {})) taken_(std::move(client.connection), client.goes_on);
  }
}

bool Hatch::is_over() {
  const std::lock_guard lock(mutex_);
  return closes_ && (clients_.empty() || Clock::now() >= *closes_);
}

void Hatch::serve(int socket) {
  const auto found = clients_.find(socket);
  if (found == clients_.end()) {
    eventfd_t woken = 0;
    if (socket == wake_event_) ::eventfd_read(wake_event_, &woken);
    return;
  }
  Client& client = found->second;
  switch (client.connection->deliver()) {
    case Delivery::whole:
      done_.push_back(remove(found));
      break;
    case Delivery::failed:
      remove(found);
      break;
    case Delivery::part:
      const std::size_t left = client.connection->undelivered();
      if (left < client.left) client.since = Clock::now();
      bytes_ -= client.left - left;
      client.left = left;
      break;
  }
}

void Hatch::leave_slow_ones() {
  const auto now = Clock::now();
  for (auto found = clients_.begin(); found != clients_.end();) {
    const auto next = std::next(found);
    Client& client = found->second;
    if (client.deadline <= now) {
      if (client.left_then - client.left < limits_.write.bytes) {
        client.connection->forget_unsent();
        remove(found);
      } else {
        client.deadline = now + limits_.write.time;
        client.left_then = client.left;
      }
    }
    found = next;
  }
}

/// The one who has taken nothing for the longest time.
void Hatch::leave_one() {
  const auto slowest = std::ranges::min_element(
      clients_, {}, [](const Clients::value_type& client) { return client.second.since; });
  slowest->second.connection->forget_unsent();
  remove(slowest);
}

Hatch::Client Hatch::remove(Clients::iterator client) {
  epoll_ctl(epoll_, EPOLL_CTL_DEL, client->first, nullptr);
  Client removed = std::move(client->second);
  bytes_ -= removed.left;
  clients_.erase(client);
  return removed;
}

}  // namespace signorini::server
