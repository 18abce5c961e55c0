#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace signorini::server {

/// Where clients wait for their replies without a thread each.
class WaitingRoom {
 public:
  using Clock = std::chrono::steady_clock;
  /// Calls what it is given, from any thread, as soon as the client need not wait any more, while what is
  /// returned lives.
  using Subscribe = std::function<std::shared_ptr<void>(std::function<void()> ready)>;
  using GoOn = std::function<void(bool client_left)>;

  WaitingRoom();
  ~WaitingRoom();

  WaitingRoom(const WaitingRoom&) = delete;
  WaitingRoom& operator=(const WaitingRoom&) = delete;

  /// Calls `go_on` once: when it is ready or the time is over, when the client has closed the socket, its
  /// sending side at least, or when nobody waits any more.
  void add(int socket, Clock::time_point until, const Subscribe& subscribe, GoOn go_on);

  /// Nobody waits any more.
  void stop();

 private:
  class Bell;

  struct Client {
    int socket;
    Clock::time_point until;
    GoOn go_on;
    std::shared_ptr<void> subscription;
  };
  using Clients = std::map<std::uint64_t, Client>;  ///< by number

  void run();
  void send_on(std::uint64_t number, bool client_left);
  void send_on_late();
  int milliseconds_to_next();

  const int epoll_;
  const std::shared_ptr<Bell> bell_;

  std::mutex mutex_;
  bool stopping_ = false;
  Clients clients_;
  std::uint64_t last_number_ = 0;
  std::thread thread_;
};

}  // namespace signorini::server
