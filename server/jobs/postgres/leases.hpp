#pragma once

#include <atomic>
#include <optional>

#include "server/jobs/fleet.hpp"
#include "server/jobs/postgres/database.hpp"

namespace signorini::server::postgres {

/// Of entries of a sweep: before whatever else their owner has queued.
constexpr int priority_of_chunks = 100;

/// Of a job with which too many services died.
Ending attempts_used_up();

/// The fleet of those who use a database: who runs which job, and how far he is.
class Leases : public Fleet {
 public:
  Leases(const Database& database, std::chrono::milliseconds lease) : database_(database), lease_(lease) {}

  std::optional<Claim> claim(const Wish& wish) override;
  std::chrono::milliseconds lease() const override { return lease_; }
  std::vector<Standing> renew(std::span<const Heartbeat> heartbeats) override;
  void rescue() override;
  std::vector<Found> look(std::span<const Sought> sought) const override;
  bool split(const Claim& whole, std::span<const NewChunk> chunks) override;
  std::vector<ChunkStanding> chunks(const std::string& whole) const override;
  std::optional<Claim> claim_chunk(const std::string& whole) override;
  std::vector<SweepEntry> entries(const std::string& chunk) const override;
  void hint() override;
  bool wait_for_hint(std::chrono::milliseconds time) override;
  std::uint64_t stale_writes() const override { return stale_writes_; }

  /// As JobStore::give_back().
  bool give_back(const Claim& claim);

  /// Something came under a claim that was lost.
  void refuse() { ++stale_writes_; }

 private:
  /// On a connection that waits for nobody: those of others may all be in use. What a crash of the database
  /// forgets of it is done again a moment later.
  template <class Step>
  Rows with_heart(const Step& step) {
    const auto patience = std::chrono::ceil<std::chrono::seconds>(lease_ / 2);
    return database_.with_own(heart_, patience, "SET synchronous_commit = off; SET lock_timeout = '1s'",
                              step);
  }

  bool keep_within(const Claim& claim, double share);
  static bool give_back(Connection& connection, const Claim& claim);
  bool clock_jumped();

  const Database& database_;
  const std::chrono::milliseconds lease_;
  std::atomic<std::uint64_t> stale_writes_ = 0;
  std::optional<Connection> heart_;                ///< for renew() and rescue()
  std::optional<Connection> listener_;             ///< for wait_for_hint()
  std::optional<std::chrono::milliseconds> lead_;  ///< of the clock of the database before one that is steady
  std::chrono::milliseconds calm_until_{};         ///< by that one, nothing is rescued
};

}  // namespace signorini::server::postgres
