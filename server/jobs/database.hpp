#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

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

/// The statement with its values in the order of its question marks.
template <class... Values>
SQLite::Statement prepared(const SQLite::Database& database, const std::string& sql,
                           const Values&... values) {
  SQLite::Statement statement(database, sql);
  int index = 0;
  (bind(statement, ++index, values), ...);
  return statement;
}

std::string bytes_of(const SQLite::Column& column);

std::optional<Time> time_of(const SQLite::Column& column);

/// A connection to a database of jobs, which is made if it is missing: a commit that is synced survives the
/// end of the machine, the file gives room back by steps, and the function `row_seal` is known. `vfs` is the
/// name of the SQLite file layer, empty for the usual one. Throws SQLite::Exception.
SQLite::Database connect(const std::filesystem::path& file, const std::string& vfs = {});

/// A connection for a single reader, which is soon made and writes nothing.
SQLite::Database connect_to_read(const std::filesystem::path& file, const std::string& vfs);

/// In words, if the error is the machine's fault and may pass; nothing if it is ours, or lasts.
std::optional<std::string> passing_reason(const SQLite::Exception& error);

/// Whether the bytes of the database are not what was written.
bool is_damage(const SQLite::Exception& error);

}  // namespace signorini::server
