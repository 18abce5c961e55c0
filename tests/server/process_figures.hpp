#pragma once

#include <cstddef>

#include <sys/types.h>

namespace signorini::server {

constexpr std::size_t megabyte = std::size_t{1} << 20;

/// Of a process, as Linux counts.
struct ProcessFigures {
  std::size_t memory = 0;       ///< resident bytes
  std::size_t peak_memory = 0;  ///< since the start, or the last forget_peak()
  int threads = 0;
  int descriptors = 0;
};

ProcessFigures figures_of(pid_t process);
void forget_peak(pid_t process);

}  // namespace signorini::server
