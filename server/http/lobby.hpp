#pragma once

#include <atomic>
#include <chrono>
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
  std::size_t connections = 4096;  ///< that are open, and not given away
  std::size_t bytes = 16 << 20;    ///< of requests that are still coming, all together but for long bodies
  std::size_t short_body = 32 * 1024;
  std::size_t long_bodies = 128 << 20;     ///< bytes of those that come or wait to be read, all together
  double long_body_rate = 16 * 1024;       ///< bytes a second, while others wait for its room,
  std::chrono::seconds long_haste{60};     ///< and so many that it comes in this time
  std::chrono::seconds slow{5};            ///< after which the rate counts
  std::chrono::seconds idle{30};           ///< for the first bytes of a request
  std::chrono::seconds arrival{10};        ///< for its head, from then on
  std::chrono::seconds body_arrival{60};   ///< for all of it, if its body is short
  std::chrono::seconds let_in{30};         ///< for a long one, until there is room for it,
  std::chrono::seconds long_arrival{300};  ///< and for all of that from then on
  std::chrono::seconds see_off{2};         ///< for a client to notice that it has been answered
};

/// Where connections wait, without a thread each, until a whole request has come: slow and silent clients
/// cost some bytes and a descriptor. Long bodies come as long as there is room for them; the others wait in
/// their sockets.
class Lobby {
 public:
  /// Takes a connection whose request has come, with the room that its body has if that is long.
  using Serve = std::function<void(std::shared_ptr<Connection>, std::shared_ptr<void> body_room)>;
  /// Whether a request is refused by its head, so that its body need not come.
  using Refuses = std::function<bool(Connection&)>;

  Lobby(const LobbyLimits& limits, Refuses refuses, Serve serve);
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

  /// What a guest is waited for with.
  enum class Stay { arriving, queued_with_long_body, arriving_with_long_body, leaving };

  struct Guest {
    std::shared_ptr<Connection> connection;
    Stay stay;
    Clock::time_point since;
    Clock::time_point deadline;
    std::optional<Clock::time_point> begun = {};  ///< when the first bytes of the request came
    bool head_judged = false;
    std::shared_ptr<void> body_room = {};
    Clock::time_point let_in = {};  ///< with the long body
    std::size_t counted = 0;        ///< of `bytes_`
  };
  using Guests = std::map<int, Guest>;  ///< by socket

  void run();
  /// For those who are not the lobby's own thread, which lets them go first.
  std::unique_lock<std::mutex> come_in();
  void enter(Guest guest);
  void hear(int socket, std::uint32_t events);
  void judge(Guests::iterator guest);
  void judge_body(Guests::iterator guest);
  void serve(Guests::iterator guest);
  void refuse(Guests::iterator guest, const HttpError& reason);
  void let_in_long_bodies();
  Guest* next_long_body();
  bool is_too_slow(const Guest& guest, Clock::time_point now) const;
  void count(Guest& guest);
  void listen_to(const Guest& guest) const;
  void dismiss_late();
  void dismiss_largest();
  void remove(Guests::iterator guest);

  const LobbyLimits limits_;
  const Refuses refuses_;
  const Serve serve_;
  const int epoll_;
  const int wake_event_;
  Places places_;
  Places long_bodies_;  ///< one a byte

  std::atomic<int> at_door_ = 0;  ///< who wait for the lock to enter
  std::mutex mutex_;
  bool stopping_ = false;
  Guests guests_;
  std::size_t bytes_ = 0;   ///< that the guests have sent
  std::size_t queued_ = 0;  ///< with long bodies
  std::thread thread_;
};

}  // namespace signorini::server
