#pragma once

#include <string>
#include <vector>

#include "server/jobs/batch.hpp"
#include "server/jobs/sqlite/database.hpp"

namespace signorini::server {

// The rows of jobs and problems. Each carries a seal over all that it holds, so that bytes which are no
// longer what was written are not taken for true. One without a seal comes from an older version.

/// The columns that job_of() reads.
extern const std::string job_columns;
constexpr int job_column_count = 12;

/// An expression: whether the row of `jobs` is as it was written.
extern const std::string is_intact;

/// From now on every change of a row of `jobs` by this connection renews its seal.
void seal_changes(SQLite::Database& database);

/// One whose row is not intact is `failed`, and nothing but its id, status and owner is told of it.
Job job_of(const SQLite::Statement& row);

/// What batch_of() reads of `batches`.
extern const std::string batch_columns;
/// Nothing if it is damaged.
std::optional<Batch> batch_of(const SQLite::Statement& row);

/// The problem as it was sent; null if it is missing or damaged.
std::shared_ptr<const std::string> problem_of(const Database& database, const std::string& id);

/// Within a transaction: makes a job `failed` because its `what` is damaged. It has ended at the time
/// `retention` at the latest.
void fail_as_damaged(Database& database, const std::string& id, const std::string& what,
                     std::int64_t retention);

}  // namespace signorini::server
