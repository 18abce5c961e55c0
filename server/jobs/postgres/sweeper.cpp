#include "server/jobs/postgres/sweeper.hpp"

#include <spdlog/spdlog.h>

#include "server/log.hpp"

namespace signorini::server::postgres {

void Sweeper::ended(std::size_t bytes) {
  constexpr std::chrono::seconds between_sweeps{1};
  {
    const std::lock_guard lock(mutex_);
    kept_bytes_ += bytes;
    const bool is_due = std::chrono::steady_clock::now() - swept_ >= between_sweeps;
    if (!is_due && kept_bytes_ <= limits_.keep_bytes) return;
  }
  try {
    sweep();
  } catch (const StoreUnavailable&) {
    // What has ended has ended all the same.
  }
}

/// Whether nothing is to be dropped by age: for a day after the clock of the database has jumped, or nobody
/// has looked at it for long, so that somebody may set it.
bool Sweeper::holds(Connection& connection) {
  constexpr std::int64_t back = 60'000, forward = 3'600'000, hold = 86'400'000;
  const Rows rows = connection.run(
      "WITH was AS (SELECT seen FROM retention_clock) "
      "UPDATE retention_clock SET seen = now.ms, hold_until = CASE "
      "WHEN now.ms - retention_clock.seen BETWEEN $1::bigint AND $2::bigint THEN hold_until "
      "ELSE now.ms + $3::bigint END "
      "FROM was, (SELECT clock_ms() AS ms) AS now "
      "RETURNING hold_until - retention_clock.seen, retention_clock.seen - was.seen",
      Values(-back, forward, hold));
  const std::int64_t left = rows.integer(0, 0);
  if (left == hold)
    spdlog::warn(
        "the clock of the database is {} s from where the last look at it was; "
        "for a day nothing is dropped by --keep-seconds",
        rows.integer(0, 1) / 1000);
  return left > 0;
}

/// One of those who share the database does it at a time, and a little at once.
void Sweeper::sweep() {
  const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(limits_.keep).count();
  static const std::string sql =
      "WITH oldest AS (SELECT id, finished, bytes, sum(bytes) OVER (ORDER BY finished, id) AS with_older, "
      "lead(id) OVER (ORDER BY finished, id) IS NULL AS is_last FROM "
      "(SELECT id, finished, bytes FROM jobs WHERE finished IS NOT NULL AND whole IS NULL "
      "ORDER BY finished, id LIMIT 101) AS "
      "ended), "
      "kept AS (SELECT sum(ended_bytes) AS bytes FROM tallies), "
      "gone AS (DELETE FROM jobs USING oldest, kept WHERE jobs.id = oldest.id AND "
      "(($3::boolean AND oldest.finished < clock_ms() - $1::bigint) OR "
      "(kept.bytes - with_older + oldest.bytes > $2::bigint AND NOT is_last)) RETURNING jobs.id, jobs.bytes) "
      "SELECT id, bytes, (SELECT bytes FROM kept)::bigint FROM gone "
      "UNION ALL SELECT NULL, 0, bytes::bigint FROM kept";
  database_.with([&](Connection& connection) {
    Transaction transaction(connection);
    const Rows chosen =
        connection.run("SELECT pg_try_advisory_xact_lock(hashtext(current_schema() || ' sweep'))");
    if (!chosen.boolean(0, 0)) return true;
    const Rows rows = connection.run(sql, Values(age, limits_.keep_bytes, !holds(connection)));
    // Whoever followed a solve has seen its last iterations by then; they are in its result too.
    connection.run(
        "DELETE FROM progress WHERE (SELECT finished FROM jobs WHERE id = job) < clock_ms() - 60000");
    transaction.commit();
    std::size_t kept = 0;
    for (int row = 0; row < rows.size(); ++row) {
      if (rows.is_null(row, 0)) {
        kept += static_cast<std::size_t>(rows.integer(row, 2));
        continue;
      }
      const LogField job("job", rows.text(row, 0));
      spdlog::info("dropped bytes={}", rows.integer(row, 1));
      kept -= static_cast<std::size_t>(rows.integer(row, 1));
    }
    const std::lock_guard lock(mutex_);
    kept_bytes_ = kept;
    swept_ = std::chrono::steady_clock::now();
    return true;
  });
}

}  // namespace signorini::server::postgres
