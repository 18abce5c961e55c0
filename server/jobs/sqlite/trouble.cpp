// What stands in the way of a store: a full disk, a limit, damage.

#include "server/jobs/sqlite/store.hpp"

#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include "server/jobs/sqlite/file_limit.hpp"
#include "server/jobs/sqlite/schema.hpp"
#include "server/jobs/sqlite/steps.hpp"

namespace signorini::server {
namespace {

std::string damage_in_words(const SQLite::Exception& error) {
  return "the database in the data directory is damaged (" + std::string(error.getErrorStr()) +
         "): start the service again, which repairs it, or stop it and run `signorinid check` with the "
         "directory";
}

}  // namespace

void rethrow_as_unavailable(const SQLite::Exception& error) {
  if (error.getErrorCode() == SQLITE_FULL) throw DiskFull();
  if (const auto reason = passing_reason(error)) throw StoreUnavailable(*reason);
  if (is_damage(error)) throw StoreUnavailable(damage_in_words(error));
  throw;
}

void SqliteStore::note_trouble(const SQLite::Exception& error) const {
  const std::lock_guard lock(trouble_mutex_);
  if (is_damage(error)) {
    if (!damage_) spdlog::error("{}", damage_in_words(error));
    damage_ = damage_in_words(error);
  } else if (const auto reason = passing_reason(error)) {
    if (!trouble_) spdlog::error("{}", *reason);
    trouble_ = reason;
  }
}

/// Throws StoreUnavailable if a result so long would leave too little of what files may grow by: where the
/// log cannot grow, not even a deletion can be written. The end of a job without a result is always let
/// through.
void SqliteStore::require_growth(std::size_t bytes) const {
  if (bytes == 0) return;
  if (const auto limit = limit_of_growth(directory_.database(), bytes + DiskReserve::bytes / 2))
    throw StoreUnavailable(*limit);
}

/// Why there is no room for more than what frees some; with the mutex.
std::optional<std::string> SqliteStore::hindrance() {
  if (auto limit = limit_of_growth(directory_.database(), DiskReserve::bytes)) return limit;
  return reserve_.room() ? std::nullopt : std::optional<std::string>(DiskFull().what());
}

/// On the disk, for more than what frees some.
bool SqliteStore::has_room() {
  const std::lock_guard lock(trouble_mutex_);
  return !hindrance();
}

/// Throws StoreUnavailable if nothing more is to be put on the disk.
void SqliteStore::require_room() {
  const std::lock_guard lock(trouble_mutex_);
  const std::optional<std::string> reason = hindrance();
  if (!reason) return;
  if (!trouble_) spdlog::error("{}", *reason);
  trouble_ = reason;
  throw StoreUnavailable(*reason);
}

std::optional<std::string> SqliteStore::trouble() {
  {
    const std::lock_guard lock(trouble_mutex_);
    if (damage_) return damage_;
    if (auto reason = hindrance()) return reason;
    if (!trouble_) return std::nullopt;
  }
  try {
    write([&] {
      // Writes the first page, as it is.
      writer_.exec("PRAGMA user_version = " + std::to_string(schema_version()));
      return true;
    });
  } catch (const StoreUnavailable& unavailable) {
    return unavailable.what();
  }
  const std::lock_guard lock(trouble_mutex_);
  if (trouble_) spdlog::info("the data directory can be written again");
  trouble_.reset();
  return std::nullopt;
}

}  // namespace signorini::server
