#pragma once

#include <string>

#include "server/jobs/postgres/connection.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server::postgres {

/// A statement that returns columns of the jobs that are asked for, newest first.
struct Selection {
  std::string sql;
  Values values;
};

/// At most so many of them, none older than the oldest. The query must outlive what is returned, and its
/// title be in lower case.
Selection selection(const std::string& columns, const ListQuery& query, const std::string& oldest,
                    std::optional<std::size_t> limit);

/// One that returns the oldest job of which a page reads the title, if there may be older ones.
Selection oldest_read(const ListQuery& query);

}  // namespace signorini::server::postgres
