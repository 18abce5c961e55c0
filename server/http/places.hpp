#pragma once

#include <atomic>
#include <functional>
#include <memory>

namespace signorini::server {

/// A limited number of places.
class Places {
 public:
  /// `on_leave` is called whenever a place becomes free.
  explicit Places(std::size_t count, std::function<void()> on_leave = {})
      : count_(count), on_leave_(std::move(on_leave)) {}

  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  std::size_t count() const { return count_; }
  std::size_t taken() const { return taken_; }

  /// A place, or several, until the last copy of it is gone; null if there are not so many. The places must
  /// outlive it.
  std::shared_ptr<void> take(std::size_t number = 1) {
    if (taken_.fetch_add(number) + number > count_) {
      taken_ -= number;
      return nullptr;
    }
    return {this, [this, number](void*) {
              taken_ -= number;
              if (on_leave_) on_leave_();
            }};
  }

 private:
  const std::size_t count_;
  const std::function<void()> on_leave_;
  std::atomic<std::size_t> taken_ = 0;
};

}  // namespace signorini::server
