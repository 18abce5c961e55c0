#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "server/jobs/live_solve.hpp"

namespace signorini::server {

/// What happens to a job while somebody watches it: written by the scheduler, read by everybody.
class Watch {
 public:
  /// Its solve from its start on, also when it has ended; null while the job is queued.
  std::shared_ptr<const LiveSolve> live() const {
    const std::lock_guard lock(mutex_);
    return live_;
  }

  /// Nothing more happens to the job in this process: it has ended, or waits for the next process.
  bool over() const { return over_; }

  void begin(std::shared_ptr<const LiveSolve> live) {
    const std::lock_guard lock(mutex_);
    live_ = std::move(live);
  }
  void end() { over_ = true; }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const LiveSolve> live_;
  std::atomic<bool> over_ = false;
};

}  // namespace signorini::server
