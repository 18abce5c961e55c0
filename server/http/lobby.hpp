#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "server/http/connection.hpp"
#include "server/http/places.hpp"

namespace signorini::server {

struct LobbyLimits {
  std::size_t connections = 4096;  ///< that are open, wherever they are
  std::size_t bytes = 16 << 20;    ///< of requests that are still coming, all together
  std::size_t head = 64 * 1024;    ///< bytes of one request's head, and of its body
  std::size_t body = 32 * 1024;
  std::size_t long_bodies = 32;           ///< longer ones that are read at the same time
  std::chrono::seconds idle{30};          ///< for the first bytes of a request
  std::chrono::seconds arrival{10};       ///< for its head, from then on
  std::chrono::seconds body_arrival{60};  ///< for all of it
  std::chrono::seconds see_off{2};        ///< for a client to notice that it has been answered
};

/// Where connections wait, without a thread each, until a whole request has come: slow and silent clients
/// cost some bytes and a descriptor. Bodies that are too long to wait for here are let in a few at a time.
class Lobby {
 public:
  /// Takes a connection whose request has come.
  using Serve = std::function<void(std::shared_ptr<Connection>)>;

  Lobby(const LobbyLimits& limits, Serve serve);
  ~Lobby();

  Lobby(const Lobby&) = delete;
  Lobby& operator=(const Lobby&) = delete;

  /// A place for a new connection; if all are taken, the guest who has waited longest goes. Null if nobody
  /// waits.
  std::shared_ptr<void> take_place();

  /// Waits for the next request of the connection.
  void admit(std::shared_ptr<Connection> connection);

  /// Ends the sending side and reads on for a moment: closing while the client still sends would reset the
  /// connection, and the client would lose the reply.
  void see_off(std::shared_ptr<Connection> connection);

  /// Serves those whose request has come, and closes the others.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;

  struct Guest {
    std::shared_ptr<Connection> connection;
    Clock::time_point since;
    Clock::time_point deadline;
    std::optional<Clock::time_point> begun;  ///< when the first bytes of the request came
    bool leaving = false;
  };
  using Guests = std::map<int, Guest>;  ///< by socket

  void run();
  void enter(Guest guest);
  void hear(int socket);
  void judge(Guests::iterator guest);
  Clock::time_point deadline_of(Guest& guest) const;
  void let_in_long_bodies();
  void dismiss_late();
  void dismiss_largest();
  void remove(Guests::iterator guest);

  const LobbyLimits limits_;
  const Serve serve_;
  const int epoll_;
  const int wake_event_;
  Places places_;
  Places long_bodies_;

  std::mutex mutex_;
  bool stopping_ = false;
  Guests guests_;
  std::size_t bytes_ = 0;                                     ///< that the guests have sent
  std::deque<std::shared_ptr<Connection>> with_long_bodies_;  ///< that wait for a place
  std::thread thread_;
};

}  // namespace signorini::server
