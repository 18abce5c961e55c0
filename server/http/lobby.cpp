#include "server/http/lobby.hpp"

#include <algorithm>
#include <array>
#include <ranges>
#include <utility>
#include <vector>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "server/http/error.hpp"
#include "server/http/turns.hpp"

namespace signorini::server {
namespace {

constexpr int look_at_guests_ms = 250;  // how late somebody is sent away

constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";

}  // namespace

Lobby::Lobby(const LobbyLimits& limits, Refuses refuses, Serve serve)
    : limits_(limits),
      refuses_(std::move(refuses)),
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
  const auto lock = come_in();
  const auto oldest = std::ranges::min_element(
      guests_, {}, [](const Guests::value_type& guest) { return guest.second.since; });
  if (oldest == guests_.end()) return nullptr;
  remove(oldest);
  return places_.take();
}

void Lobby::admit(std::shared_ptr<Connection> connection) {
  const auto now = Clock::now();
  enter({std::move(connection), Stay::arriving, now, now + limits_.idle});
}

void Lobby::see_off(std::shared_ptr<Connection> connection) {
  connection->end_sending();
  const auto now = Clock::now();
  enter({std::move(connection), Stay::leaving, now, now + limits_.see_off});
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
  for (const int socket : sockets) hear(socket, EPOLLIN);
  while (!guests_.empty()) remove(guests_.begin());
}

void Lobby::run() {
  auto look_around = Clock::now();
  for (;;) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(epoll_, events.data(), events.size(), look_at_guests_ms);
    // Who waits at the door of a busy lobby would find it locked again each time.
    while (at_door_ > 0) std::this_thread::yield();
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    for (int i = 0; i < count; ++i) {
      if (events[i].data.fd == wake_event_) {
        eventfd_t woken = 0;
        ::eventfd_read(wake_event_, &woken);
        let_in_long_bodies();
      } else {
        hear(events[i].data.fd, events[i].events);
      }
    }
    if (Clock::now() < look_around) continue;
    dismiss_late();
    look_around = Clock::now() + std::chrono::milliseconds(look_at_guests_ms);
  }
}

std::unique_lock<std::mutex> Lobby::come_in() {
  ++at_door_;
  std::unique_lock lock(mutex_);
  --at_door_;
  return lock;
}

void Lobby::enter(Guest guest) {
  const auto lock = come_in();
  if (stopping_) return;
  const int socket = guest.connection->socket();
  const auto entered = guests_.emplace(socket, std::move(guest)).first;
  epoll_event readable{EPOLLIN, {.fd = socket}};
  epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &readable);
  // What came together with the request before.
  if (entered->second.stay == Stay::arriving) judge(entered);
}

/// Takes what a guest has sent.
void Lobby::hear(int socket, std::uint32_t events) {
  const auto found = guests_.find(socket);
  if (found == guests_.end()) return;
  Guest& guest = found->second;
  Receipt receipt = Receipt::nothing;
  if (guest.stay != Stay::queued_with_long_body) {
    receipt = guest.connection->receive();
  } else if ((events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0) {
    receipt = Receipt::closed;
  }
  if (receipt == Receipt::closed) {
    remove(found);
  } else if (receipt == Receipt::bytes && guest.stay != Stay::leaving) {
    judge(found);
  }
  if (bytes_ > limits_.bytes) dismiss_largest();
}

/// Lets a guest in whose request has come, and sees to it that the rest of the others does.
void Lobby::judge(Guests::iterator found) {
  Guest& guest = found->second;
  const MessageReader::Stage stage = guest.connection->reader().stage();
  if (stage == MessageReader::Stage::whole) return serve(found);
  if (stage == MessageReader::Stage::nothing) return;
  if (!guest.begun) guest.begun = Clock::now();
  if (stage == MessageReader::Stage::body) return judge_body(found);
  guest.deadline = *guest.begun + limits_.arrival;
  count(guest);
}

/// A body that is long, or that the client sends when it is told to, is not waited for in vain.
void Lobby::judge_body(Guests::iterator found) {
  Guest& guest = found->second;
  MessageReader& reader = guest.connection->reader();
  const bool is_long = reader.message().body.size() + reader.awaited() > limits_.short_body;
  if ((is_long || reader.expects_continue()) && !std::exchange(guest.head_judged, true) &&
      refuses_(*guest.connection)) {
    reader.leave_body();
    return serve(found);
  }
  count(guest);
  if (guest.stay == Stay::arriving_with_long_body) return;
  guest.deadline = *guest.begun + limits_.body_arrival;
  if (is_long) {
    guest.deadline = *guest.begun + limits_.let_in;
    guest.stay = Stay::queued_with_long_body;
    ++queued_;
    listen_to(guest);
    // The queue is looked through once for all that have come.
    ::eventfd_write(wake_event_, 1);
  } else if (reader.expects_continue()) {
    reader.told_to_continue();
    guest.connection->send_at_once(go_on);
  }
}

/// Its body, which has come, keeps the room that it takes.
void Lobby::serve(Guests::iterator guest) {
  std::shared_ptr<Connection> connection = guest->second.connection;
  std::shared_ptr<void> body_room = std::move(guest->second.body_room);
  remove(guest);
  if (std::exchange(body_room, nullptr))
    body_room = long_bodies_.take(connection->reader().message().body.size());
  serve_(std::move(connection), std::move(body_room));
}

void Lobby::refuse(Guests::iterator guest, const HttpError& reason) {
  guest->second.connection->reader().refuse(reason);
  serve(guest);
}

void Lobby::let_in_long_bodies() {
  while (Guest* const guest = next_long_body()) {
    MessageReader& reader = guest->connection->reader();
    guest->body_room = long_bodies_.take(reader.longest_body());
    if (!guest->body_room) return;
    --queued_;
    guest->stay = Stay::arriving_with_long_body;
    guest->let_in = Clock::now();
    guest->deadline = guest->let_in + limits_.long_arrival;
    count(*guest);
    listen_to(*guest);
    if (!reader.expects_continue()) continue;
    reader.told_to_continue();
    guest->connection->send_at_once(go_on);
  }
}

/// Of those for whom there is room, the one that is due first; null if there is none. Nobody takes more than
/// half of the room that is left, so that there is always some for a shorter one.
Lobby::Guest* Lobby::next_long_body() {
  Guest* next = nullptr;
  if (queued_ == 0) return next;
  const std::size_t room = (long_bodies_.count() - std::min(long_bodies_.taken(), long_bodies_.count())) / 2;
  const auto due_of = [](const Guest& guest) {
    return due(*guest.begun, guest.connection->reader().longest_body());
  };
  for (auto& [socket, guest] : guests_) {
    const bool fits =
        guest.stay == Stay::queued_with_long_body && guest.connection->reader().longest_body() <= room;
    if (fits && (next == nullptr || due_of(guest) < due_of(*next))) next = &guest;
  }
  return next;
}

/// Whether others could have the room of its long body with more right.
bool Lobby::is_too_slow(const Guest& guest, Clock::time_point now) const {
  if (queued_ == 0 || guest.stay != Stay::arriving_with_long_body || now - guest.let_in < limits_.slow)
    return false;
  const MessageReader& reader = guest.connection->reader();
  const double rate =
      std::max(limits_.long_body_rate, static_cast<double>(reader.longest_body()) /
                                           std::chrono::duration<double>(limits_.long_haste).count());
  return static_cast<double>(reader.message().body.size()) <
         rate * std::chrono::duration<double>(now - guest.let_in).count();
}

/// Counts what a guest has sent. Long bodies that come are counted by their room.
void Lobby::count(Guest& guest) {
  bytes_ -= guest.counted;
  guest.counted = guest.body_room ? 0 : guest.connection->reader().size();
  bytes_ += guest.counted;
}

void Lobby::listen_to(const Guest& guest) const {
  const int socket = guest.connection->socket();
  epoll_event event{guest.stay == Stay::queued_with_long_body ? EPOLLRDHUP : EPOLLIN, {.fd = socket}};
  epoll_ctl(epoll_, EPOLL_CTL_MOD, socket, &event);
}

void Lobby::dismiss_late() {
  const auto now = Clock::now();
  for (auto found = guests_.begin(); found != guests_.end();) {
    const auto next = std::next(found);
    const Guest& guest = found->second;
    if (guest.deadline <= now || is_too_slow(guest, now)) {
      if (guest.stay == Stay::leaving || !guest.begun) {
        remove(found);
      } else {
        refuse(found, guest.stay == Stay::queued_with_long_body ? too_many_bodies() : request_timeout());
      }
    }
    found = next;
  }
}

void Lobby::dismiss_largest() {
  remove(std::ranges::max_element(guests_, {},
                                  [](const Guests::value_type& guest) { return guest.second.counted; }));
}

void Lobby::remove(Guests::iterator guest) {
  bytes_ -= guest->second.counted;
  if (guest->second.stay == Stay::queued_with_long_body) --queued_;
  epoll_ctl(epoll_, EPOLL_CTL_DEL, guest->first, nullptr);
  guests_.erase(guest);
}

}  // namespace signorini::server
