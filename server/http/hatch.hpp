#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/http/connection.hpp"

namespace signorini::server {

struct HatchLimits {
  std::size_t clients = 1024;         ///< that have not taken their replies
  std::size_t bytes = 64 << 20;       ///< of which so much is left, all together
  WriteLimits write = {};             ///< how much a client has to take in which time
  std::chrono::seconds last_call{1};  ///< for those who still take when all ends
};

/// Where clients take replies that are there, without a thread each: what the system does not take at once
/// waits here until the client has read enough. Who takes too little is left, and where there are too many,
/// the one who has taken nothing for the longest time.
class Hatch {
 public:
  /// Called when a reply is taken, by any thread.
  using Taken = std::function<void(std::shared_ptr<Connection>, bool goes_on)>;

  Hatch(const HatchLimits& limits, Taken taken);
  ~Hatch();

  Hatch(const Hatch&) = delete;
  Hatch& operator=(const Hatch&) = delete;

  /// Hands the reply out; whether the connection goes on then is passed on.
  void deliver(std::shared_ptr<Connection> connection, std::string reply, bool goes_on);

  /// Waits a moment for those who still take.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;

  struct Client {
    std::shared_ptr<Connection> connection;
    bool goes_on;
    std::size_t left;         ///< of the reply
    Clock::time_point since;  ///< when some of it was taken
    Clock::time_point deadline;
    std::size_t left_then;  ///< when the deadline was set
  };
  using Clients = std::map<int, Client>;  ///< by socket

  void run();
  bool is_over();
  void serve(int socket);
  void leave_slow_ones();
  void leave_one();
  Client remove(Clients::iterator client);

  const HatchLimits limits_;
  const Taken taken_;
  const int epoll_;
  const int wake_event_;

  std::mutex mutex_;
  std::optional<Clock::time_point> closes_;
  Clients clients_;
  std::size_t bytes_ = 0;     ///< that are left of all replies
  std::vector<Client> done_;  ///< who have taken theirs; of the thread alone
  std::thread thread_;
};

}  // namespace signorini::server
