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

/// At most so many of them. The query must outlive what is returned, and its title be in lower case.
Selection selection(const std::string& columns, const ListQuery& query, std::optional<std::size_t> limit);

}  // namespace signorini::server::postgres
