#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "server/http/connection.hpp"
#include "server/http/semaphore.hpp"

namespace signorini::server {

struct PendingLimits {
  std::size_t connections = 4096;  ///< that are open, and not given away
  std::size_t bytes = 16 << 20;    ///< of requests that are still coming, all together but for long bodies
  std::size_t short_body = 32 * 1024;
  std::size_t long_bodies = 128 << 20;       ///< bytes of those that come or wait to be read, all together
  double long_body_rate = 16 * 1024;         ///< bytes a second, while others wait for its room,
  std::chrono::seconds long_haste{60};       ///< and so many that it comes in this time
  std::chrono::seconds slow{5};              ///< after which the rate counts
  std::chrono::seconds idle{30};             ///< for the first bytes of a request
  std::chrono::seconds head_time{10};        ///< for its head, from then on
  std::chrono::seconds body_time{60};        ///< for all of it, if its body is short
  std::chrono::seconds let_in{30};           ///< for a long one, until there is room for it,
  std::chrono::seconds long_body_time{300};  ///< and for all of that from then on
  std::chrono::seconds linger{2};            ///< for a client to notice that it has been answered
};

/// Where connections wait, without a thread each, until a whole request has come: slow and silent clients
/// cost some bytes and a descriptor. Bodies are read behind the heads that have come, a few at a time, so
/// that who asks for something short does not wait for them. Long bodies come as long as there is room for
/// them; the others wait in their sockets.
class PendingConnections {
 public:
  /// Takes a connection whose request has come, with the room that its body has if that is long.
  using Serve = std::function<void(std::shared_ptr<Connection>, std::shared_ptr<void> body_room)>;
  /// Whether a request is refused by its head, so that its body need not come.
  using Refuses = std::function<bool(Connection&)>;

  PendingConnections(const PendingLimits& limits, Refuses refuses, Serve serve);
  ~PendingConnections();

  PendingConnections(const PendingConnections&) = delete;
  PendingConnections& operator=(const PendingConnections&) = delete;

  /// A place for a new connection; if all are taken, the one that has waited longest goes. Null if nobody
  /// waits.
  std::shared_ptr<void> take_place();

  /// Waits for the next request of the connection.
  void admit(std::shared_ptr<Connection> connection);

  /// Ends the sending side and reads on for a moment: closing while the client still sends would reset the
  /// connection, and the client would lose the reply.
  void linger(std::shared_ptr<Connection> connection);

  /// Serves those whose request has come, and closes the others.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;

  /// What is waited for.
  enum class Stay { receiving, waiting_for_room, receiving_long_body, lingering };

  struct Entry {
    std::shared_ptr<Connection> connection;
    Stay stay;
    Clock::time_point deadline;
    int epoll;  ///< that hears of it
    std::list<int>::iterator in_line = {};
    std::optional<Clock::time_point> begun = {};  ///< when the first bytes of the request came
    bool head_judged = false;
    std::shared_ptr<void> body_room = {};
    Clock::time_point let_in = {};  ///< with the long body
    std::size_t counted = 0;        ///< of `bytes_`
  };
  using Entries = std::map<int, Entry>;  ///< by socket

  void run();
  void give_way(std::unique_lock<std::mutex>& lock);
  /// For those who are not its own thread, which lets them go first.
  std::unique_lock<std::mutex> lock_before_thread();
  void enter(Entry entry);
  void hear(int socket, std::uint32_t events);
  void hear_bodies();
  void hear_behind_heads(Entry& entry) const;
  void judge(Entries::iterator entry);
  void judge_body(Entries::iterator entry);
  void serve(Entries::iterator entry);
  void refuse(Entries::iterator entry, const HttpError& reason);
  void let_in_long_bodies();
  Entry* next_long_body();
  bool is_too_slow(const Entry& entry, Clock::time_point now) const;
  void count(Entry& entry);
  void listen_to(const Entry& entry) const;
  void dismiss_late();
  void dismiss_largest();
  void remove(Entries::iterator entry);

  const PendingLimits limits_;
  const Refuses refuses_;
  const Serve serve_;
  const int heads_;   ///< the epoll of those whose head is coming, and of the other one
  const int bodies_;  ///< that of all others
  const int wake_event_;
  Semaphore open_;
  Semaphore long_bodies_;  ///< one a byte

  std::atomic<int> waiting_for_lock_ = 0;  ///< who wait for the lock to enter
  std::mutex mutex_;
  bool stopping_ = false;
  Entries entries_;
  std::list<int> line_;     ///< their sockets, who has waited longest first
  std::size_t bytes_ = 0;   ///< that the clients have sent
  std::size_t queued_ = 0;  ///< with long bodies
  std::thread thread_;
};

}  // namespace signorini::server
