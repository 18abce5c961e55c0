#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "server/jobs/live_solve.hpp"

namespace signorini::server {

/// What happens to a job while somebody watches it: written by the scheduler, read by everybody.
class Watch {
 public:
  using Told = std::function<void()>;

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
  /// What was seen of a solve of another process. It may be one of this process that has just ended, as it
  /// was a moment before, of which all is known.
  void begin_elsewhere(std::shared_ptr<const LiveSolve> live) {
    const std::lock_guard lock(mutex_);
    if (!live_ || live_->started() != live->started()) live_ = std::move(live);
  }
  /// Tells those who wanted to be told.
  void end() {
    std::vector<std::weak_ptr<const Told>> all;
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
      all.swap(told_);
    }
    for (const auto& each : all) {
      if (const auto told = each.lock()) (*told)();
    }
  }

  /// Calls `told` once it is over, at once if it is already, while what is returned lives.
  std::shared_ptr<void> tell(Told told) const {
    const auto kept = std::make_shared<Told>(std::move(told));
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(told_, [](const auto& each) { return each.expired(); });
      if (!over_) {
        told_.push_back(kept);
        return kept;
      }
    }
    (*kept)();
    return kept;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::vector<std::weak_ptr<const Told>> told_;
  std::shared_ptr<const LiveSolve> live_;
  std::atomic<bool> over_ = false;
};

}  // namespace signorini::server
