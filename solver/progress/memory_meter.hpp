#pragma once

#include <cstddef>
#include <cstdint>

namespace signorini {

/// What this thread has allocated and not freed since the meter was made, and the most that it was. A solve
/// has one thread, so that this is its memory, whatever else the process does. Meters lie one within the
/// other.
///
/// Counts all that is allocated by `new`, and by `malloc` in what is linked with this; nothing under a
/// sanitizer, which has an allocator of its own.
class MemoryMeter {
 public:
  MemoryMeter();
  ~MemoryMeter();

  MemoryMeter(const MemoryMeter&) = delete;
  MemoryMeter& operator=(const MemoryMeter&) = delete;

  std::int64_t peak() const;  ///< bytes

 private:
  std::int64_t start_, peak_around_;
};

/// While it lives, the meters of this thread take no note of what it allocates and frees: it is of no solve.
class Unmetered {
 public:
  Unmetered();
  ~Unmetered();

  Unmetered(const Unmetered&) = delete;
  Unmetered& operator=(const Unmetered&) = delete;

 private:
  std::int64_t before_;
};

/// Takes so many bytes off the meters of this thread, which has allocated them: they are somebody else's now,
/// who frees them unmetered.
void hand_over(std::size_t bytes);

/// While it lives, what this thread allocates beyond so many bytes more than it has now fails:
/// std::bad_alloc.
class MemoryLimit {
 public:
  explicit MemoryLimit(double bytes);
  ~MemoryLimit();

  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  /// Whether something has failed by the limit that this thread has, or had last.
  static bool was_met();
};

}  // namespace signorini
