#pragma once

#include <chrono>
#include <thread>

namespace signorini::server {

/// Whether a condition is met within some time; it is asked again and again. Machines are slow at times.
template <class Condition>
bool becomes(const Condition& condition, std::chrono::seconds time = std::chrono::seconds(60)) {
  using Clock = std::chrono::steady_clock;
  for (const auto until = Clock::now() + time; Clock::now() < until;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace signorini::server
