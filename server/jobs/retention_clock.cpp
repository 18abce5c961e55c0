#include "server/jobs/retention_clock.hpp"

#include <algorithm>
#include <cstdlib>

#include <spdlog/spdlog.h>

#include "server/jobs/boot_time.hpp"

namespace signorini::server {
namespace {

constexpr std::int64_t minute = 60'000;
constexpr std::int64_t most_between_services = 24 * 60 * minute;
constexpr std::int64_t hold = 10 * minute;
constexpr std::int64_t jump = minute;  // more than corrections by NTP

std::int64_t wall() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::int64_t steady() {
  return boot_time().count();
}

}  // namespace

RetentionClock::RetentionClock(const std::optional<KeptClock>& kept)
    : began_(steady()), lead_(wall() - began_), hold_until_(began_) {
  const std::int64_t wall_now = began_ + lead_;
  const std::int64_t between = kept ? wall_now - kept->wall : 0;
  start_ = kept ? kept->retention + std::clamp<std::int64_t>(between, 0, most_between_services) : wall_now;
  if (between >= -jump && between <= most_between_services) return;
  hold_until_ += hold;
  spdlog::warn(
      "the clock of the machine is {} days from where the last service left it; no more than one counts for "
      "--keep-seconds",
      between / most_between_services);
}

std::int64_t RetentionClock::now() const {
  return start_ + steady() - began_;
}

KeptClock RetentionClock::reading() const {
  return {now(), wall()};
}

bool RetentionClock::holds() {
  const std::int64_t now = steady();
  const std::int64_t lead = wall() - now;
  if (std::abs(lead - lead_) > jump) {
    spdlog::warn("the clock of the machine has jumped by {} s; what is kept does not grow older by that",
                 (lead - lead_) / 1000);
    hold_until_ = now + hold;
  }
  lead_ = lead;
  return now < hold_until_;
}

}  // namespace signorini::server
