#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/jobs/job.hpp"

namespace signorini::server {

/// Bytes as the value of a statement, which must outlive it.
struct Blob {
  const std::string_view bytes;
};

inline void bind(SQLite::Statement& statement, int index, const Blob& blob) {
  statement.bindNoCopy(index, blob.bytes.data(), static_cast<int>(blob.bytes.size()));
}

template <class Value>
void bind(SQLite::Statement& statement, int index, const Value& value) {
  statement.bind(index, value);
}

/// A statement that goes back to its connection when nobody needs it any more.
class Prepared : public SQLite::Statement {
 public:
  Prepared(SQLite::Statement&& statement, std::optional<SQLite::Statement>& place)
      : Statement(std::move(statement)), place_(&place) {}
  Prepared(Prepared&& other) noexcept
      : Statement(std::move(other)), place_(std::exchange(other.place_, nullptr)) {}
  Prepared& operator=(Prepared&&) = delete;
  ~Prepared();

 private:
  std::optional<SQLite::Statement>* place_;
};

/// A connection that compiles each text once, for as many texts as the program has: SQLite takes longer to
/// compile a change of a job, with its triggers, than to do it. For one thread at a time, with its
/// statements.
class Database : public SQLite::Database {
 public:
  using SQLite::Database::Database;

  Prepared prepare(const std::string& sql) const;

 private:
  mutable std::unordered_map<std::string, std::optional<SQLite::Statement>> idle_;
};

/// The statement with its values in the order of its question marks.
template <class... Values>
Prepared prepared(const Database& database, const std::string& sql, const Values&... values) {
  Prepared statement = database.prepare(sql);
  int index = 0;
  (server::bind(statement, ++index, values), ...);  // std has another one
  return statement;
}

std::string bytes_of(const SQLite::Column& column);

std::optional<Time> time_of(const SQLite::Column& column);

/// A connection to a database of jobs, which is made if it is missing: a commit that is synced survives the
/// end of the machine, the file gives room back by steps, and the function `row_seal` is known. `vfs` is the
/// name of the SQLite file layer, empty for the usual one. Throws SQLite::Exception.
Database connect(const std::filesystem::path& file, const std::string& vfs = {});

/// A connection for a single reader, which is soon made and writes nothing.
Database connect_to_read(const std::filesystem::path& file, const std::string& vfs);

/// In words, if the error is the machine's fault and may pass; nothing if it is ours, or lasts.
std::optional<std::string> passing_reason(const SQLite::Exception& error);

/// Whether the bytes of the database are not what was written.
bool is_damage(const SQLite::Exception& error);

}  // namespace signorini::server
