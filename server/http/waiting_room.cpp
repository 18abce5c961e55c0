#include "server/http/waiting_room.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace signorini::server {
namespace {

constexpr std::uint64_t nobody = 0;

}  // namespace

/// Rung by those for whom a client has waited, also when the room is gone.
class WaitingRoom::Bell {
 public:
  Bell() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  ~Bell() { ::close(event_); }

  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  int event() const { return event_; }
  void ring() const { ::eventfd_write(event_, 1); }

  void ring_for(std::uint64_t client) {
    {
      const std::lock_guard lock(mutex_);
      called_.push_back(client);
    }
    ring();
  }

  /// For whom it was rung.
  std::vector<std::uint64_t> answer() {
    eventfd_t rings = 0;
    ::eventfd_read(event_, &rings);
    const std::lock_guard lock(mutex_);
    return std::exchange(called_, {});
  }

 private:
  const int event_;
  std::mutex mutex_;
  std::vector<std::uint64_t> called_;
};

WaitingRoom::WaitingRoom() : epoll_(epoll_create1(EPOLL_CLOEXEC)), bell_(std::make_shared<Bell>()) {
  epoll_event rung{EPOLLIN, {.u64 = nobody}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, bell_->event(), &rung);
  thread_ = std::thread(&WaitingRoom::run, this);
}

WaitingRoom::~WaitingRoom() {
  stop();
  ::close(epoll_);
}

void WaitingRoom::add(int socket, Clock::time_point until, const Subscribe& subscribe, GoOn go_on) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_) {
      const std::uint64_t number = ++last_number_;
      clients_.emplace(number, Client{socket, until, std::move(go_on), nullptr});
      epoll_event left{EPOLLRDHUP, {.u64 = number}};
      epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &left);
      clients_.at(number).subscription = subscribe([bell = bell_, number] { bell->ring_for(number); });
      bell_->ring();  // there may be a nearer time
      return;
    }
  }
  go_on(false);
}

void WaitingRoom::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    stopping_ = true;
  }
  bell_->ring();
  thread_.join();
  const std::lock_guard lock(mutex_);
  while (!clients_.empty()) send_on(clients_.begin()->first, false);
}

void WaitingRoom::run() {
  for (;;) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(epoll_, events.data(), events.size(), milliseconds_to_next());
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    for (int i = 0; i < count; ++i) {
      if (events[i].data.u64 != nobody) send_on(events[i].data.u64, true);
    }
    for (const std::uint64_t number : bell_->answer()) send_on(number, false);
    send_on_late();
  }
}

void WaitingRoom::send_on(std::uint64_t number, bool client_left) {
  const auto found = clients_.find(number);
  if (found == clients_.end()) return;
  const Client client = std::move(found->second);
  clients_.erase(found);
  epoll_ctl(epoll_, EPOLL_CTL_DEL, client.socket, nullptr);
  client.go_on(client_left);
}

void WaitingRoom::send_on_late() {
  const auto now = Clock::now();
  std::vector<std::uint64_t> late;
  for (const auto& [number, client] : clients_) {
    if (client.until <= now) late.push_back(number);
  }
  for (const std::uint64_t number : late) send_on(number, false);
}

int WaitingRoom::milliseconds_to_next() {
  const std::lock_guard lock(mutex_);
  if (clients_.empty()) return -1;
  const auto next = std::ranges::min_element(
      clients_, {}, [](const Clients::value_type& client) { return client.second.until; });
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(next->second.until - Clock::now()).count();
  return static_cast<int>(std::clamp<decltype(left)>(left, 0, 3'600'000));
}

}  // namespace signorini::server
