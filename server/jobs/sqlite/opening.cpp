// How a store opens its directory, and what it finds there.

#include "server/jobs/sqlite/store.hpp"

#include <filesystem>

#include <spdlog/spdlog.h>

#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/repair.hpp"
#include "server/jobs/sqlite/schema.hpp"
#include "server/jobs/sqlite/steps.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

constexpr int attempts_allowed = 3;

void repair_if_damaged(const DataDir& directory, const std::string& vfs) {
  if (!std::filesystem::exists(directory.database())) return;
  for (const std::string& damage : repair(directory, Depth::rows, vfs).damage)
    spdlog::error("the data directory was damaged: {}", damage);
}

/// A database that an older version made gives no room back; all of it is written anew, once.
void give_room_back(SQLite::Database& database) {
  constexpr int incremental = 2;
  if (database.execAndGet("PRAGMA auto_vacuum").getInt() == incremental) return;
  spdlog::info("the database is written anew, so that its file can shrink from now on");
  database.exec("PRAGMA auto_vacuum = INCREMENTAL; VACUUM");
}

/// What a killed service has left needs room to be opened.
Database open_jobs(const DataDir& directory, const std::string& vfs, DiskReserve& reserve) {
  if (!reserve.room()) reserve.spend();
  repair_if_damaged(directory, vfs);
  try {
    Database database = connect(directory.database(), vfs);
    migrate(database);
    give_room_back(database);
    seal_changes(database);
    return database;
  } catch (const SQLite::Exception& error) {
    throw CannotOpenStore("cannot open the jobs in " + directory.database().string() + ": " +
                          error.getErrorStr() + " (--data-dir)");
  }
}

std::optional<KeptClock> kept_clock(const Database& database) {
  auto row = prepared(database, "SELECT retention, wall FROM state");
  if (!row.executeStep()) return std::nullopt;
  return KeptClock{row.getColumn(0).getInt64(), row.getColumn(1).getInt64()};
}

Ending attempts_used_up() {
  Ending ending;
  ending.status = JobStatus::failed;
  ending.error = ProblemDetails{
      "attempts-used-up", "The service died while it solved the problem",
      "It died " + std::to_string(attempts_allowed) +
          " times while this solve ran, and does not try it again. Most often the machine has too little "
          "memory for it (POST /v1/validate estimates it): take a coarser mesh or fewer workers."};
  return ending;
}

}  // namespace

SqliteStore::SqliteStore(const std::filesystem::path& directory, const StoreLimits& limits,
                         const std::string& vfs)
    : limits_(limits),
      directory_(directory),
      vfs_(vfs),
      reserve_(directory_.reserve()),
      writer_(open_jobs(directory_, vfs_, reserve_)),
      reader_(connect(directory_.database(), vfs_)) {
  try {
    recover();
  } catch (const std::runtime_error& error) {
    throw CannotOpenStore("cannot open the jobs in " + directory.string() + ": " + error.what());
  }
}

/// The process that left these jobs as running is dead: nobody else has the directory.
void SqliteStore::recover() {
  write_what_frees([&] {
    clock_ = RetentionClock(kept_clock(writer_));
    const KeptClock clock = clock_.reading();
    prepared(writer_,
             "REPLACE INTO state SELECT 1, ifnull(sum(bytes), 0), ?, ? FROM jobs WHERE ended IS NOT NULL",
             clock.retention, clock.wall)
        .exec();
    std::vector<std::pair<std::string, Ending>> over;
    {
      auto row = prepared(writer_,
                          "SELECT id, cancel_asked FROM jobs WHERE status = 'running' "
                          "AND (cancel_asked OR attempt - given_back >= ?)",
                          attempts_allowed);
      while (row.executeStep()) {
        over.emplace_back(row.getColumn(0).getString(),
                          row.getColumn(1).getInt() != 0
                              ? cancelled_ending("The solve was cancelled before it ended.")
                              : attempts_used_up());
      }
    }
    for (const auto& [id, ending] : over) {
      end(id, JobStatus::running, std::nullopt, ending, {});
      const LogField job("job", id);
      spdlog::warn("{} kind={}", name(ending.status), ending.error->kind);
    }
    const int again =
        writer_.exec("UPDATE jobs SET status = 'queued', started = NULL WHERE status = 'running'");
    if (again > 0) spdlog::warn("{} solves ran when the service died; they are queued again", again);
    return true;
  });
}

}  // namespace signorini::server
