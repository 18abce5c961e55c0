#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace signorini::server {

/// Makes ids, of jobs and of requests: 26 letters and digits (a ULID: 48 bits of milliseconds, 80 random
/// bits, Crockford's base 32). Each is greater than the one before, so that ids sort by age and a page of a
/// list can start after any of them.
class UniqueIds {
 public:
  std::string next();

 private:
  std::mutex mutex_;
  std::array<std::uint8_t, 16> last_{};
};

bool is_unique_id(std::string_view text);

}  // namespace signorini::server
