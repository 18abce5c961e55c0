#pragma once

#include <atomic>
#include <functional>
#include <memory>

namespace signorini::server {

/// A limited number of places, of which a holder lets go by itself.
class Semaphore {
 public:
  /// `on_release` is called whenever a place becomes free.
  explicit Semaphore(std::size_t count, std::function<void()> on_release = {})
      : count_(count), on_release_(std::move(on_release)) {}

  Semaphore(const Semaphore&) = delete;
  Semaphore& operator=(const Semaphore&) = delete;

  std::size_t count() const { return count_; }
  std::size_t acquired() const { return acquired_; }

  /// A place, or several, until the last copy of it is gone; null if there are not so many. The semaphore
  /// must outlive it.
  std::shared_ptr<void> try_acquire(std::size_t number = 1) {
    if (acquired_.fetch_add(number) + number > count_) {
      acquired_ -= number;
      return nullptr;
    }
    return {this, [this, number](void*) {
              acquired_ -= number;
              if (on_release_) on_release_();
            }};
  }

 private:
  const std::size_t count_;
  const std::function<void()> on_release_;
  std::atomic<std::size_t> acquired_ = 0;
};

}  // namespace signorini::server
