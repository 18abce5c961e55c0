#include "server/http/lobby.hpp"

#include <algorithm>
#include <array>
#include <ranges>
#include <vector>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "server/http/arrival.hpp"
#include "server/http/error.hpp"

namespace signorini::server {
namespace {

constexpr int look_around_ms = 250;  // how late somebody is sent away

/// To a client whose request did not come in time.
std::string too_late() {
  const std::string body = problem_response(408, details_of_status(408)).body;
  return "HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nCache-Control: no-store\r\n"
         "Content-Type: application/problem+json\r\nContent-Length: " +
         std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace

Lobby::Lobby(const LobbyLimits& limits, Serve serve)
    : limits_(limits),
      serve_(std::move(serve)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      wake_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      places_(limits.connections),
      long_bodies_(limits.long_bodies, [this] { ::eventfd_write(wake_event_, 1); }) {
  epoll_event wake{EPOLLIN, {.fd = wake_event_}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_event_, &wake);
  thread_ = std::thread(&Lobby::run, this);
}

Lobby::~Lobby() {
  stop();
  ::close(epoll_);
  ::close(wake_event_);
}

std::shared_ptr<void> Lobby::take_place() {
  std::shared_ptr<void> place = places_.take();
  if (place) return place;
  const std::lock_guard lock(mutex_);
  const auto oldest = std::ranges::min_element(
      guests_, {}, [](const Guests::value_type& guest) { return guest.second.since; });
  if (oldest == guests_.end()) return nullptr;
  remove(oldest);
  return places_.take();
}

void Lobby::admit(std::shared_ptr<Connection> connection) {
  const auto now = Clock::now();
  enter({std::move(connection), now, now + limits_.idle, std::nullopt, false});
}

void Lobby::see_off(std::shared_ptr<Connection> connection) {
  connection->stream().end_sending();
  const auto now = Clock::now();
  enter({std::move(connection), now, now + limits_.see_off, std::nullopt, true});
}

void Lobby::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    stopping_ = true;
  }
  ::eventfd_write(wake_event_, 1);
  thread_.join();
  const std::lock_guard lock(mutex_);
  std::vector<int> sockets;
  for (const auto& [socket, guest] : guests_) sockets.push_back(socket);
  for (const int socket : sockets) hear(socket);
  while (!guests_.empty()) remove(guests_.begin());
  with_long_bodies_.clear();
}

void Lobby::run() {
  auto look_around = Clock::now();
  for (;;) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(epoll_, events.data(), events.size(), look_around_ms);
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    for (int i = 0; i < count; ++i) {
      if (events[i].data.fd == wake_event_) {
        eventfd_t woken = 0;
        ::eventfd_read(wake_event_, &woken);
        let_in_long_bodies();
      } else {
        hear(events[i].data.fd);
      }
    }
    if (Clock::now() < look_around) continue;
    dismiss_late();
    look_around = Clock::now() + std::chrono::milliseconds(look_around_ms);
  }
}

void Lobby::enter(Guest guest) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return;
  SocketStream& stream = guest.connection->stream();
  const int socket = stream.socket();
  bytes_ += stream.buffered().size();
  const auto entered = guests_.emplace(socket, std::move(guest)).first;
  epoll_event readable{EPOLLIN, {.fd = socket}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &readable);
  // What came together with the request before.
  if (!stream.buffered().empty()) judge(entered);
}

/// Takes what a guest has sent.
void Lobby::hear(int socket) {
  const auto found = guests_.find(socket);
  if (found == guests_.end()) return;
  SocketStream& stream = found->second.connection->stream();
  const std::size_t before = stream.buffered().size();
  const Receipt receipt = stream.receive();
  if (found->second.leaving) stream.forget_buffered();
  bytes_ += stream.buffered().size() - before;
  if (receipt == Receipt::closed) {
    remove(found);
  } else if (receipt == Receipt::bytes && !found->second.leaving) {
    judge(found);
  }
  if (bytes_ > limits_.bytes) dismiss_largest();
}

/// Lets a guest in whose request has come.
void Lobby::judge(Guests::iterator guest) {
  const SocketStream& stream = guest->second.connection->stream();
  const Arrival arrival = arrival_of(stream.buffered(), limits_.head, limits_.body);
  if (arrival == Arrival::part) {
    guest->second.deadline = deadline_of(guest->second);
    return;
  }
  std::shared_ptr<Connection> connection = guest->second.connection;
  remove(guest);
  if (arrival == Arrival::whole) {
    serve_(std::move(connection));
  } else {
    with_long_bodies_.push_back(std::move(connection));
    let_in_long_bodies();
  }
}

void Lobby::let_in_long_bodies() {
  while (!with_long_bodies_.empty()) {
    std::shared_ptr<void> place = long_bodies_.take();
    if (!place) return;
    with_long_bodies_.front()->stream().hold_while_body_comes(std::move(place));
    serve_(std::move(with_long_bodies_.front()));
    with_long_bodies_.pop_front();
  }
}

/// By when the rest of a request must be there.
Lobby::Clock::time_point Lobby::deadline_of(Guest& guest) const {
  if (!guest.begun) guest.begun = Clock::now();
  const bool head_is_there = guest.connection->stream().buffered().find("\r\n\r\n") != std::string_view::npos;
  return *guest.begun + (head_is_there ? limits_.body_arrival : limits_.arrival);
}

void Lobby::dismiss_late() {
  const auto now = Clock::now();
  for (auto guest = guests_.begin(); guest != guests_.end();) {
    const auto next = std::next(guest);
    if (guest->second.deadline <= now) {
      SocketStream& stream = guest->second.connection->stream();
      if (!guest->second.leaving && !stream.buffered().empty()) stream.send_at_once(too_late());
      remove(guest);
    }
    guest = next;
  }
}

void Lobby::dismiss_largest() {
  remove(std::ranges::max_element(guests_, {}, [](const Guests::value_type& guest) {
    return guest.second.connection->stream().buffered().size();
  }));
}

void Lobby::remove(Guests::iterator guest) {
  bytes_ -= guest->second.connection->stream().buffered().size();
  epoll_ctl(epoll_, EPOLL_CTL_DEL, guest->first, nullptr);
  guests_.erase(guest);
}

}  // namespace signorini::server
