#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

#include "server/jobs/postgres/database.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server::postgres {

/// Drops what has ended and is beyond the limits.
class Sweeper {
 public:
  Sweeper(const Database& database, const StoreLimits& limits) : database_(database), limits_(limits) {}

  /// Something has ended that takes so many bytes. Sweeps when the limits may be met, and now and then.
  void ended(std::size_t bytes);

 private:
  void sweep();
  static bool holds(Connection& connection);

  const Database& database_;
  const StoreLimits limits_;

  std::mutex mutex_;
  std::chrono::steady_clock::time_point swept_{};
  std::size_t kept_bytes_ = 0;  ///< as was counted last, and what has ended here since then
};

}  // namespace signorini::server::postgres
