#include "server/jobs/postgres/database.hpp"

#include <algorithm>
#include <array>

#include <spdlog/spdlog.h>

#include "server/jobs/postgres/migrations.hpp"
#include "server/jobs/postgres/url.hpp"

namespace signorini::server::postgres {
namespace {

/// Four replicas leave some of the 100 that PostgreSQL allows by default to others.
constexpr std::size_t most_connections = 16;

/// Whether it may pass: the connection, resources, an operator, a conflict, the system, or a server that only
/// reads.
bool may_pass(const std::string& state) {
  constexpr std::array classes{"08", "53", "57", "40", "58", "25", "55"};
  return state.empty() || std::ranges::find(classes, state.substr(0, 2)) != classes.end();
}

std::string in_words(const Error& error) {
  return "the database cannot be used: " + std::string(error.what());
}

}  // namespace

Database::Database(const std::string& url) : url_(url), pool_(url, most_connections) {
  try {
    pool_.with([](Connection& connection) {
      migrate(connection);
      return true;
    });
  } catch (const Error& error) {
    throw CannotOpenStore("cannot use the database " + without_password(url) +
                          " (--database): " + error.what());
  }
}

/// Inside a handler of the error.
void Database::rethrow_as_unavailable(const Error& error) const {
  if (!may_pass(error.state)) throw;
  const std::lock_guard lock(trouble_mutex_);
  if (trouble_.empty()) spdlog::error("{}", in_words(error));
  trouble_ = in_words(error);
  throw StoreUnavailable(trouble_);
}

std::optional<std::string> Database::trouble() const {
  const bool was_in_trouble = [&] {
    const std::lock_guard lock(trouble_mutex_);
    return !trouble_.empty();
  }();
  try {
    // A write, if the last step failed.
    run(was_in_trouble ? "UPDATE tallies SET queued = queued WHERE shard = 0" : "SELECT 1");
  } catch (const StoreUnavailable& unavailable) {
    return unavailable.what();
  }
  const std::lock_guard lock(trouble_mutex_);
  if (!trouble_.empty()) spdlog::info("the database can be used again");
  trouble_.clear();
  return std::nullopt;
}

}  // namespace signorini::server::postgres
