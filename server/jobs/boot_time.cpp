#include "server/jobs/boot_time.hpp"

#include <ctime>

namespace signorini::server {

std::chrono::milliseconds boot_time() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) +
         std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace signorini::server
