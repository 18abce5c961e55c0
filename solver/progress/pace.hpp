#pragma once

#include <cstddef>

#include "progress/progress.hpp"

namespace signorini {

/// Looks at the observer each time that a long loop has touched so many numbers: some milliseconds of work.
class Pace {
 public:
  explicit Pace(Progress& progress) : progress_(progress) {}

  /// Throws what Progress::check() throws.
  void add(std::size_t numbers) {
    touched_ += numbers;
    if (touched_ < kMost) return;
    touched_ = 0;
    progress_.check();
  }

 private:
  static constexpr std::size_t kMost = 1 << 18;
  Progress& progress_;
  std::size_t touched_ = 0;
};

}  // namespace signorini
