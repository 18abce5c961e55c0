#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

namespace signorini::server {

/// The version of the tables that this service reads and writes; the database has it as its `user_version`.
int schema_version();

/// Brings an empty database, or one of an older version, step by step to the given version. Each step is
/// done as a whole or not at all. Throws CannotOpenStore if the database is of a newer version.
void migrate(SQLite::Database& database, int version = schema_version());

}  // namespace signorini::server
