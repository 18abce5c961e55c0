#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace signorini::server {

/// What a clock of retention showed when it was last kept, both in milliseconds.
struct KeptClock {
  std::int64_t retention = 0;
  std::int64_t wall = 0;  ///< the clock of the machine at that moment, since 1970
};

/// By which jobs that have ended grow old. It begins as the clock of the machine; from then on it counts the
/// time that has really passed while the service runs, whatever is done to the clock of the machine; and of
/// the time between two services, which only that clock tells, a day at most.
class RetentionClock {
 public:
  explicit RetentionClock(const std::optional<KeptClock>& kept = std::nullopt);

  /// In milliseconds.
  std::int64_t now() const;

  /// To be kept for the next service.
  KeptClock reading() const;

  /// Whether nothing is to be dropped by age for now: for ten minutes after the clock of the machine has
  /// jumped, which is logged, or was found far from where it was kept, so that somebody may look.
  bool holds();

 private:
  std::int64_t start_;  ///< what this clock showed at `began_`
  std::int64_t began_;  ///< milliseconds of a clock that nobody sets
  std::int64_t lead_;   ///< of the machine's clock before that one, when last looked at
  std::int64_t hold_until_;
};

}  // namespace signorini::server
