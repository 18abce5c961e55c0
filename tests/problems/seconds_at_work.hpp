#pragma once

#include <ctime>

namespace signorini {

/// Seconds that this thread has had a core: what other programs take meanwhile does not count.
inline double seconds_at_work() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace signorini
