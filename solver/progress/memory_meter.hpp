#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <thread>

namespace signorini {

/// What this thread has allocated and not freed since the meter was made, and the most that it was. A solve
/// has one thread and those that help it (MemoryOfHelpers), so that this is its memory, whatever else the
/// process does. Meters lie one within the other.
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

/// What others allocate for the solve of this thread while it lives: as it ends, the meters and the limit of
/// this thread have counted that as if it were its own, and all of the helpers' peaks at once.
class MemoryOfHelpers {
 public:
  MemoryOfHelpers();
  ~MemoryOfHelpers();

  MemoryOfHelpers(const MemoryOfHelpers&) = delete;
  MemoryOfHelpers& operator=(const MemoryOfHelpers&) = delete;

  /// While it lives, what the thread that has made it allocates is of that solve, and its limit holds.
  class Share {
   public:
    explicit Share(MemoryOfHelpers& all);
    ~Share();

    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    MemoryOfHelpers& all_;
    std::int64_t now_before_, peak_before_, limit_before_;
    bool limit_met_before_;
  };

 private:
  struct Helper {
    std::int64_t now = 0, peak = 0;
  };

  MemoryMeter own_;
  std::mutex mutex_;
  std::map<std::thread::id, Helper> helpers_;
  bool limit_met_ = false;
  const std::int64_t limit_;  ///< of what is not allocated yet
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
