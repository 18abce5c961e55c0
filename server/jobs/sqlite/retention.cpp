// What is kept, and what is dropped beyond the limits.

#include "server/jobs/sqlite/store.hpp"

#include <spdlog/spdlog.h>

#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/steps.hpp"
#include "server/log.hpp"

namespace signorini::server {

void SqliteStore::tidy() {
  constexpr std::int64_t between_readings = 600'000;
  write_what_frees([&] {
    drop_beyond_limits();
    const KeptClock clock = clock_.reading();
    prepared(writer_, "UPDATE state SET retention = ?, wall = ? WHERE abs(wall - ?) > ?", clock.retention,
             clock.wall, clock.wall, between_readings)
        .exec();
    return true;
  });
  shrink();
}

/// Within a step, which should stay short: what is left over goes with the next one.
void SqliteStore::drop_beyond_limits() {
  constexpr int most_at_once = 100;
  const bool by_age = !clock_.holds();
  for (int i = 0; i < most_at_once; ++i) {
    writer_.exec("SAVEPOINT dropping");
    try {
      const bool dropped = drop_oldest_beyond_limits(by_age);
      writer_.exec("RELEASE dropping");
      if (!dropped) return;
    } catch (const SQLite::Exception& error) {
      // What cannot be dropped must not hinder what is to be kept.
      if (!is_damage(error)) throw;
      note_trouble(error);
      writer_.exec("ROLLBACK TO dropping; RELEASE dropping");
      return;
    }
  }
}

/// False if nothing is beyond the limits.
bool SqliteStore::drop_oldest_beyond_limits(bool by_age) {
  const std::int64_t oldest =
      clock_.now() - std::chrono::duration_cast<std::chrono::milliseconds>(limits_.keep).count();
  auto row = prepared(writer_, "SELECT id, ended, bytes, " + is_intact +
                                   ", (SELECT ended_bytes FROM state) FROM jobs WHERE ended IS NOT NULL "
                                   "ORDER BY ended, id LIMIT 2");
  if (!row.executeStep()) return false;
  const std::string id = row.getColumn(0).getString();
  const bool expired = by_age && row.getColumn(1).getInt64() < oldest;
  const std::int64_t bytes = row.getColumn(2).getInt64();
  const bool intact = row.getColumn(3).getInt() != 0;
  const std::int64_t kept_bytes = row.getColumn(4).getInt64();
  const bool last = !row.executeStep();
  if (!expired && (last || kept_bytes <= static_cast<std::int64_t>(limits_.keep_bytes))) return false;
  row.reset();
  if (!intact) {
    fail_as_damaged(writer_, id, "entry in the list of solves", clock_.now());
    return true;
  }
  prepared(writer_, "DELETE FROM jobs WHERE id = ?", id).exec();
  prepared(writer_, "UPDATE state SET ended_bytes = ended_bytes - ?", bytes).exec();
  const LogField job("job", id);
  spdlog::info("dropped bytes={} kept_bytes={} ({})", bytes, kept_bytes - bytes,
               expired ? "--keep-seconds" : "--keep-bytes");
  return true;
}

/// Gives some of the pages that nothing uses back to the disk, if there are many, or if the disk is full.
void SqliteStore::shrink() {
  constexpr int many = 256, at_once = 4096;
  try {
    commits_.run_alone([this] {
      const int unused = writer_.execAndGet("PRAGMA freelist_count").getInt();
      const bool full = !has_room();
      if (unused <= (full ? 0 : many)) return;
      // The log first, so that there is room for that of what is moved.
      if (full) writer_.exec("PRAGMA wal_checkpoint(TRUNCATE)");
      writer_.exec("PRAGMA incremental_vacuum(" + std::to_string(at_once) + ")");
      writer_.exec(full ? "PRAGMA wal_checkpoint(TRUNCATE)" : "PRAGMA wal_checkpoint(PASSIVE)");
      if (full) has_room();
    });
  } catch (const SQLite::Exception& error) {
    note_trouble(error);
  }
}

}  // namespace signorini::server
