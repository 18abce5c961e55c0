#include "server/http/pending_connections.hpp"

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

/// How many bodies are read before heads are looked for again, and how much is read of a head at once, with
/// which some of its body may come: the chunks of 16 KiB may take half a millisecond.
constexpr std::size_t bodies_at_once = 8, bytes_of_head = 1024;

constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";

}  // namespace

PendingConnections::PendingConnections(const PendingLimits& limits, Refuses refuses, Serve serve)
    : limits_(limits),
      refuses_(std::move(refuses)),
      serve_(std::move(serve)),
      heads_(epoll_create1(EPOLL_CLOEXEC)),
      bodies_(epoll_create1(EPOLL_CLOEXEC)),
      wake_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      open_(limits.connections),
      long_bodies_(limits.long_bodies, [this] { ::eventfd_write(wake_event_, 1); }) {
  for (const int other : {wake_event_, bodies_}) {
    epoll_event readable{EPOLLIN, {.fd = other}};
    epoll_ctl(heads_, EPOLL_CTL_ADD, other, &readable);
  }
  thread_ = std::thread(&PendingConnections::run, this);
}

PendingConnections::~PendingConnections() {
  stop();
  ::close(bodies_);
  ::close(heads_);
  ::close(wake_event_);
}

std::shared_ptr<void> PendingConnections::take_place() {
  std::shared_ptr<void> place = open_.try_acquire();
  if (place) return place;
  const auto lock = lock_before_thread();
  if (line_.empty()) return nullptr;
  remove(entries_.find(line_.front()));
  return open_.try_acquire();
}

void PendingConnections::admit(std::shared_ptr<Connection> connection) {
  const auto now = Clock::now();
  enter({std::move(connection), Stay::receiving, now + limits_.idle, heads_});
}

void PendingConnections::linger(std::shared_ptr<Connection> connection) {
  connection->end_sending();
  const auto now = Clock::now();
  enter({std::move(connection), Stay::lingering, now + limits_.linger, bodies_});
}

void PendingConnections::stop() {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    stopping_ = true;
  }
  ::eventfd_write(wake_event_, 1);
  thread_.join();
  const std::lock_guard lock(mutex_);
  std::vector<int> sockets;
  for (const auto& [socket, entry] : entries_) sockets.push_back(socket);
  for (const int socket : sockets) hear(socket, EPOLLIN);
  while (!entries_.empty()) remove(entries_.begin());
}

void PendingConnections::run() {
  auto look_around = Clock::now();
  for (;;) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(heads_, events.data(), events.size(), look_at_guests_ms);
    std::unique_lock lock(mutex_, std::defer_lock);
    give_way(lock);
    if (stopping_) return;
    bool bodies_come = false;
    for (int i = 0; i < count; ++i) {
      if (waiting_for_lock_ > 0) give_way(lock);
      if (events[i].data.fd == wake_event_) {
        eventfd_t woken = 0;
        ::eventfd_read(wake_event_, &woken);
        let_in_long_bodies();
      } else if (events[i].data.fd == bodies_) {
        bodies_come = true;
      } else {
        hear(events[i].data.fd, events[i].events);
      }
    }
    if (bodies_come) hear_bodies();
    if (Clock::now() < look_around) continue;
    dismiss_late();
    look_around = Clock::now() + std::chrono::milliseconds(look_at_guests_ms);
  }
}

/// Lets others go first: who waits for the lock of a busy thread would find it taken again each time.
void PendingConnections::give_way(std::unique_lock<std::mutex>& lock) {
  if (lock.owns_lock()) lock.unlock();
  while (waiting_for_lock_ > 0) std::this_thread::yield();
  lock.lock();
}

std::unique_lock<std::mutex> PendingConnections::lock_before_thread() {
  ++waiting_for_lock_;
  std::unique_lock lock(mutex_);
  --waiting_for_lock_;
  return lock;
}

void PendingConnections::enter(Entry entry) {
  const auto lock = lock_before_thread();
  if (stopping_) return;
  const int socket = entry.connection->socket();
  const auto entered = entries_.emplace(socket, std::move(entry)).first;
  entered->second.in_line = line_.insert(line_.end(), socket);
  epoll_event readable{EPOLLIN, {.fd = socket}};
  epoll_ctl(entered->second.epoll, EPOLL_CTL_ADD, socket, &readable);
  // What came together with the request before.
  if (entered->second.stay == Stay::receiving) judge(entered);
}

/// Takes what a client has sent.
void PendingConnections::hear(int socket, std::uint32_t events) {
  const auto found = entries_.find(socket);
  if (found == entries_.end()) return;
  Entry& entry = found->second;
  Receipt receipt = Receipt::nothing;
  if (entry.stay != Stay::waiting_for_room) {
    receipt = entry.epoll == heads_ ? entry.connection->receive(bytes_of_head) : entry.connection->receive();
  } else if ((events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) != 0) {
    receipt = Receipt::closed;
  }
  if (receipt == Receipt::closed) {
    remove(found);
  } else if (receipt == Receipt::bytes && entry.stay != Stay::lingering) {
    judge(found);
  }
  if (bytes_ > limits_.bytes) dismiss_largest();
}

/// In turn. One of them at least, the others as long as nobody comes.
void PendingConnections::hear_bodies() {
  std::array<epoll_event, bodies_at_once> events;
  const int count = epoll_wait(bodies_, events.data(), events.size(), 0);
  for (int i = 0; i < count && (i == 0 || waiting_for_lock_ == 0); ++i)
    hear(events[i].data.fd, events[i].events);
}

void PendingConnections::hear_behind_heads(Entry& entry) const {
  if (entry.epoll == bodies_) return;
  const int socket = entry.connection->socket();
  epoll_event readable{EPOLLIN, {.fd = socket}};
  epoll_ctl(std::exchange(entry.epoll, bodies_), EPOLL_CTL_DEL, socket, nullptr);
  epoll_ctl(bodies_, EPOLL_CTL_ADD, socket, &readable);
}

/// Lets a client in whose request has come, and sees to it that the rest of the others does.
void PendingConnections::judge(Entries::iterator found) {
  Entry& entry = found->second;
  const MessageReader::Stage stage = entry.connection->reader().stage();
  if (stage == MessageReader::Stage::whole) return serve(found);
  if (stage == MessageReader::Stage::nothing) return;
  if (!entry.begun) entry.begun = Clock::now();
  if (stage == MessageReader::Stage::body) return judge_body(found);
  entry.deadline = *entry.begun + limits_.head_time;
  count(entry);
}

/// A body that is long, or that the client sends when it is told to, is not waited for in vain.
void PendingConnections::judge_body(Entries::iterator found) {
  Entry& entry = found->second;
  MessageReader& reader = entry.connection->reader();
  const bool is_long = reader.message().body.size() + reader.awaited() > limits_.short_body;
  if ((is_long || reader.expects_continue()) && !std::exchange(entry.head_judged, true) &&
      refuses_(*entry.connection)) {
    reader.leave_body();
    return serve(found);
  }
  hear_behind_heads(entry);
  count(entry);
  if (entry.stay == Stay::receiving_long_body) return;
  entry.deadline = *entry.begun + limits_.body_time;
  if (is_long) {
    entry.deadline = *entry.begun + limits_.let_in;
    entry.stay = Stay::waiting_for_room;
    ++queued_;
    listen_to(entry);
    // The queue is looked through once for all that have come.
    ::eventfd_write(wake_event_, 1);
  } else if (reader.expects_continue()) {
    reader.told_to_continue();
    entry.connection->send_at_once(go_on);
  }
}

/// Its body, which has come, keeps the room that it takes.
void PendingConnections::serve(Entries::iterator entry) {
  std::shared_ptr<Connection> connection = entry->second.connection;
  std::shared_ptr<void> body_room = std::move(entry->second.body_room);
  remove(entry);
  if (std::exchange(body_room, nullptr))
    body_room = long_bodies_.try_acquire(connection->reader().message().body.size());
  serve_(std::move(connection), std::move(body_room));
}

void PendingConnections::refuse(Entries::iterator entry, const HttpError& reason) {
  entry->second.connection->reader().refuse(reason);
  serve(entry);
}

void PendingConnections::let_in_long_bodies() {
  while (Entry* const entry = next_long_body()) {
    MessageReader& reader = entry->connection->reader();
    entry->body_room = long_bodies_.try_acquire(reader.longest_body());
    if (!entry->body_room) return;
    --queued_;
    entry->stay = Stay::receiving_long_body;
    entry->let_in = Clock::now();
    entry->deadline = entry->let_in + limits_.long_body_time;
    count(*entry);
    listen_to(*entry);
    if (!reader.expects_continue()) continue;
    reader.told_to_continue();
    entry->connection->send_at_once(go_on);
  }
}

/// Of those for whom there is room, the one that is due first; null if there is none. Nobody takes more than
/// half of the room that is left, so that there is always some for a shorter one.
PendingConnections::Entry* PendingConnections::next_long_body() {
  Entry* next = nullptr;
  if (queued_ == 0) return next;
  const std::size_t room =
      (long_bodies_.count() - std::min(long_bodies_.acquired(), long_bodies_.count())) / 2;
  const auto due_of = [](const Entry& entry) {
    return due(*entry.begun, entry.connection->reader().longest_body());
  };
  for (auto& [socket, entry] : entries_) {
    const bool fits =
        entry.stay == Stay::waiting_for_room && entry.connection->reader().longest_body() <= room;
    if (fits && (next == nullptr || due_of(entry) < due_of(*next))) next = &entry;
  }
  return next;
}

/// Whether others could have the room of its long body with more right.
bool PendingConnections::is_too_slow(const Entry& entry, Clock::time_point now) const {
  if (queued_ == 0 || entry.stay != Stay::receiving_long_body || now - entry.let_in < limits_.slow)
    return false;
  const MessageReader& reader = entry.connection->reader();
  const double rate =
      std::max(limits_.long_body_rate, static_cast<double>(reader.longest_body()) /
                                           std::chrono::duration<double>(limits_.long_haste).count());
  return static_cast<double>(reader.message().body.size()) <
         rate * std::chrono::duration<double>(now - entry.let_in).count();
}

/// Counts what a client has sent. Long bodies that come are counted by their room.
void PendingConnections::count(Entry& entry) {
  bytes_ -= entry.counted;
  entry.counted = entry.body_room ? 0 : entry.connection->reader().size();
  bytes_ += entry.counted;
}

void PendingConnections::listen_to(const Entry& entry) const {
  const int socket = entry.connection->socket();
  epoll_event event{entry.stay == Stay::waiting_for_room ? EPOLLRDHUP : EPOLLIN, {.fd = socket}};
  epoll_ctl(entry.epoll, EPOLL_CTL_MOD, socket, &event);
}

void PendingConnections::dismiss_late() {
  const auto now = Clock::now();
  for (auto found = entries_.begin(); found != entries_.end();) {
    const auto next = std::next(found);
    const Entry& entry = found->second;
    if (entry.deadline <= now || is_too_slow(entry, now)) {
      if (entry.stay == Stay::lingering || !entry.begun) {
        remove(found);
      } else {
        refuse(found, entry.stay == Stay::waiting_for_room ? too_many_bodies() : request_timeout());
      }
    }
    found = next;
  }
}

void PendingConnections::dismiss_largest() {
  remove(std::ranges::max_element(entries_, {},
                                  [](const Entries::value_type& entry) { return entry.second.counted; }));
}

void PendingConnections::remove(Entries::iterator entry) {
  bytes_ -= entry->second.counted;
  if (entry->second.stay == Stay::waiting_for_room) --queued_;
  line_.erase(entry->second.in_line);
  epoll_ctl(entry->second.epoll, EPOLL_CTL_DEL, entry->first, nullptr);
  entries_.erase(entry);
}

}  // namespace signorini::server
