#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/fleet.hpp"

namespace signorini::server {

/// A solve that runs here.
struct Held {
  std::string job;
  std::uint64_t attempt = 0;
  std::shared_ptr<LiveSolve> live;
};

/// Renews the claims of the solves that run here and tells the fleet how far they are, about once a second.
/// Ends those that somebody wishes to end, or that are lost, also because the fleet is out of reach for
/// longer than a claim is held. Takes jobs from other runners that are silent.
class Heart {
 public:
  Heart(Fleet& fleet, std::function<std::vector<Held>()> held);
  ~Heart();

  Heart(const Heart&) = delete;
  Heart& operator=(const Heart&) = delete;

 private:
  using Clock = std::chrono::steady_clock;

  /// What is known of a solve.
  struct Pulse {
    std::uint64_t attempt = 0;
    Clock::time_point renewed;  ///< a moment before
    std::size_t told = 0;       ///< iterations
  };

  void run(const std::stop_token& stop);
  void beat();
  std::vector<Heartbeat> heartbeats(const std::vector<Held>& held);
  void lose_what_is_over(const std::vector<Held>& held);

  Fleet& fleet_;
  const std::function<std::vector<Held>()> held_;
  std::map<std::string, Pulse> pulses_;  ///< by job; of the thread
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace signorini::server
