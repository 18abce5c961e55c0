#include "server/jobs/sqlite/database.hpp"

#include <sqlite3.h>
#include <zlib.h>

namespace signorini::server {
namespace {

constexpr int busy_timeout_ms = 5000;

uLong add(uLong sum, const void* bytes, std::size_t count) {
  return crc32_z(sum, static_cast<const Bytef*>(bytes), count);
}

/// The CRC-32 of its arguments, each with its type and length: no flipped bit and no exchanged value gives
/// the same.
void row_seal(sqlite3_context* context, int count, sqlite3_value** values) {
  uLong sum = crc32_z(0, nullptr, 0);
  for (int i = 0; i < count; ++i) {
    const int type = sqlite3_value_type(values[i]);
    const std::int64_t number = type == SQLITE_INTEGER ? sqlite3_value_int64(values[i]) : 0;
    const void* const bytes = type == SQLITE_INTEGER ? nullptr : sqlite3_value_blob(values[i]);
    const int length = type == SQLITE_INTEGER ? 0 : sqlite3_value_bytes(values[i]);
    sum = add(sum, &type, sizeof(type));
    sum = add(sum, &number, sizeof(number));
    sum = add(sum, &length, sizeof(length));
    if (length > 0) sum = add(sum, bytes, static_cast<std::size_t>(length));
  }
  sqlite3_result_int64(context, static_cast<sqlite3_int64>(sum));
}

}  // namespace

std::string bytes_of(const SQLite::Column& column) {
  return {static_cast<const char*>(column.getBlob()), static_cast<std::size_t>(column.getBytes())};
}

std::optional<Time> time_of(const SQLite::Column& column) {
  if (column.isNull()) return std::nullopt;
  return Time(std::chrono::milliseconds(column.getInt64()));
}

Prepared::~Prepared() {
  if (place_ == nullptr) return;
  tryReset();
  clearBindings();
  place_->emplace(std::move(*this));
}

Prepared Database::prepare(const std::string& sql) const {
  std::optional<SQLite::Statement>& place = idle_[sql];
  std::optional<SQLite::Statement> idle = std::exchange(place, std::nullopt);
  return {idle ? *std::move(idle) : SQLite::Statement(*this, sql), place};
}

Database connect(const std::filesystem::path& file, const std::string& vfs) {
  Database database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms, vfs);
  // How room is given back is settled before the first page is written; later this would be a write.
  if (database.execAndGet("PRAGMA page_count").getInt() == 0)
    database.exec("PRAGMA auto_vacuum = INCREMENTAL");
  // A checkpoint costs two syncs more: few of them, of 2 MiB each, for which a full disk has the reserve.
  database.exec(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA temp_store = "
      "MEMORY;"
      "PRAGMA wal_autocheckpoint = 512; PRAGMA journal_size_limit = 2097152");
  constexpr int any_number = -1;
  database.createFunction("row_seal", any_number, true, nullptr, row_seal);
  return database;
}

Database connect_to_read(const std::filesystem::path& file, const std::string& vfs) {
  return Database(file.string(), SQLite::OPEN_READWRITE, busy_timeout_ms, vfs);
}

std::optional<std::string> passing_reason(const SQLite::Exception& error) {
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return "the disk of the data directory is full";
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
      return "the data directory cannot be written: " + std::string(error.getErrorStr());
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds the database in the data directory";
    default:
      return std::nullopt;
  }
}

bool is_damage(const SQLite::Exception& error) {
  return error.getErrorCode() == SQLITE_CORRUPT || error.getErrorCode() == SQLITE_NOTADB;
}

}  // namespace signorini::server
