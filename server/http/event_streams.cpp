#include "server/http/event_streams.hpp"

#include <array>
#include <cerrno>
#include <chrono>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <spdlog/spdlog.h>

namespace signorini::server {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto tick = 50ms;                  // how late an event may be
constexpr auto patience_with_readers = 30s;  // with a client that takes nothing
constexpr int turns = 16;                    // of one subscriber before the others have theirs

}  // namespace

struct EventStreams::Subscriber {
  Subscriber(int of_client, std::string head, std::shared_ptr<EventSource> events,
             std::shared_ptr<void> of_limit)
      : socket(of_client), source(std::move(events)), place(std::move(of_limit)), unsent(std::move(head)) {}
  ~Subscriber() {
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
  }

  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// Sends what there is, but not so much that others wait for long. False if the stream has ended, or its
  /// client has gone.
  bool advance(std::chrono::milliseconds silence) {
    more = false;
    for (int turn = 0; turn < turns; ++turn) {
      if (gone || !send_unsent()) return !gone && Clock::now() - last_sent < patience_with_readers;
      if (last) return false;
      fetch();
      if (unsent.empty() && Clock::now() - last_sent >= silence) unsent = ":\n\n";
      if (unsent.empty()) return !last;
    }
    more = true;
    return true;
  }

  void fetch() {
    unsent.clear();
    sent = 0;
    try {
      last = !source->next(unsent);
    } catch (const std::exception& error) {
      spdlog::error("a stream of events broke off: {}", error.what());
      last = true;
    }
  }

  /// True if nothing is left. False if the client takes no more for now, or has gone.
  bool send_unsent() {
    while (sent < unsent.size()) {
      const ssize_t count =
          ::send(socket, unsent.data() + sent, unsent.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0) {
        gone = errno != EAGAIN && errno != EINTR;
        return false;
      }
      sent += static_cast<std::size_t>(count);
      last_sent = Clock::now();
    }
    return true;
  }

  /// Reads over what the client says meanwhile. False if it has gone.
  bool listen() const {
    std::array<char, 4096> ignored{};
    const ssize_t count = ::recv(socket, ignored.data(), ignored.size(), MSG_DONTWAIT);
    return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
  }

  const int socket;
  const std::shared_ptr<EventSource> source;
  const std::shared_ptr<void> place;
  std::string unsent;
  std::size_t sent = 0;
  bool last = false;
  bool more = false;
  bool gone = false;
  Clock::time_point last_sent = Clock::now();
};

EventStreams::EventStreams(std::size_t max_subscribers, std::chrono::milliseconds silence)
    : silence_(silence),
      open_streams_(max_subscribers),
      wake_event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_(&EventStreams::run, this) {}

EventStreams::~EventStreams() {
  stop();
  ::close(wake_event_);
}

void EventStreams::add(int socket, std::string head, std::shared_ptr<EventSource> source,
                       std::shared_ptr<void> place) {
  {
    const std::lock_guard lock(mutex_);
    newcomers_.push_back(
        std::make_unique<Subscriber>(socket, std::move(head), std::move(source), std::move(place)));
  }
  ::eventfd_write(wake_event_, 1);
}

void EventStreams::stop() {
  if (stopping_.exchange(true)) return;
  ::eventfd_write(wake_event_, 1);
  thread_.join();
}

void EventStreams::run() {
  while (!stopping_) {
    take_newcomers();
    std::erase_if(subscribers_, [this](const auto& subscriber) { return !subscriber->advance(silence_); });
    wait();
  }
  take_newcomers();
  for (const auto& subscriber : subscribers_) subscriber->advance(silence_);
  subscribers_.clear();
}

void EventStreams::take_newcomers() {
  const std::lock_guard lock(mutex_);
  for (auto& newcomer : newcomers_) subscribers_.push_back(std::move(newcomer));
  newcomers_.clear();
}

/// Until a client takes more or leaves, somebody comes, or it is time to ask the sources again.
void EventStreams::wait() {
  std::vector<pollfd> descriptors;
  descriptors.reserve(subscribers_.size() + 1);
  bool more = false;
  for (const auto& subscriber : subscribers_) {
    more = more || subscriber->more;
    const bool held_back = subscriber->sent < subscriber->unsent.size();
    descriptors.push_back({subscriber->socket, static_cast<short>(held_back ? POLLIN | POLLOUT : POLLIN), 0});
  }
  descriptors.push_back({wake_event_, POLLIN, 0});
  const int until_tick =
      subscribers_.empty() ? -1 : static_cast<int>(std::chrono::milliseconds(tick).count());
  if (::poll(descriptors.data(), descriptors.size(), more ? 0 : until_tick) <= 0) return;
  eventfd_t woken = 0;
  ::eventfd_read(wake_event_, &woken);
  for (std::size_t i = 0; i < subscribers_.size(); ++i) {
    constexpr short readable = POLLIN | POLLERR | POLLHUP;
    if ((descriptors[i].revents & readable) != 0 && !subscribers_[i]->listen()) subscribers_[i]->gone = true;
  }
}

}  // namespace signorini::server
