#pragma once

#include <string>

#include "server/jobs/batch.hpp"
#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::postgres {

/// The columns that job_of() reads.
extern const std::string job_columns;
constexpr int job_column_count = 14;

/// One whose row cannot be read is `failed`, and says so.
Job job_of(const Rows& rows, int row);

/// What batch_of() reads of `batches`.
extern const std::string batch_columns;
/// Nothing if it is damaged.
std::optional<Batch> batch_of(const Rows& rows, int row);

/// No id has anything else in it. What a client takes for one may be bytes that are no text.
bool may_be_an_id(const std::string& text);

/// A problem as it was sent; null if it is damaged.
std::shared_ptr<const std::string> problem_of(const std::string& packed);

std::optional<Time> time_of(const Rows& rows, int row, int column);

}  // namespace signorini::server::postgres
