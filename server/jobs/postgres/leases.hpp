#pragma once

#include <atomic>
#include <optional>

#include "server/jobs/fleet.hpp"
#include "server/jobs/postgres/database.hpp"

namespace signorini::server::postgres {

/// The fleet of those who use a database: who runs which job, and how far he is.
class Leases : public Fleet {
 public:
  Leases(const Database& database, std::chrono::milliseconds lease) : database_(database), lease_(lease) {}

  std::optional<Claim> claim(const Wish& wish) override;
  std::chrono::milliseconds lease() const override { return lease_; }
  std::vector<Standing> renew(std::span<const Heartbeat> heartbeats) override;
  void rescue() override;
  std::vector<Found> look(std::span<const Sought> sought) const override;
  void hint() override;
  bool wait_for_hint(std::chrono::milliseconds time) override;
  std::uint64_t stale_writes() const override { return stale_writes_; }

  /// Something came under a claim that was lost.
  void refuse() { ++stale_writes_; }

 private:
  const Database& database_;
  const std::chrono::milliseconds lease_;
  std::atomic<std::uint64_t> stale_writes_ = 0;
  std::optional<Connection> heart_;     ///< for renew(), which waits for nobody
  std::optional<Connection> listener_;  ///< for wait_for_hint()
};

}  // namespace signorini::server::postgres
